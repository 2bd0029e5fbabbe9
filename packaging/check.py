#!/usr/bin/env python3
"""Checks that all version numbers agree, and, with the tag of a release, that it can be published.

    packaging/check.py [TAG]"""

import re
import sys

import workspace


def main(tag=None):
    packages = [p for p in workspace.metadata()["packages"] if p["source"] is None]
    version = workspace.package()["version"]
    wrong = [f"{p['name']} has version {p['version']}, the workspace {version}" for p in packages if p["version"] != version]
    for package in packages:
        for needed in package["dependencies"]:
            if needed.get("path") and needed["req"] not in (f"^{version}", "*"):
                wrong.append(f"{package['name']} needs {needed['name']} {needed['req']}, the workspace has {version}")
    if tag is not None:
        if tag != f"v{version}":
            wrong.append(f"the tag is {tag}, the version {version}: tag v{version}")
        if not re.search(rf"^## {re.escape(version)}( |$)", (workspace.ROOT / "CHANGELOG.md").read_text("utf-8"), re.M):
            wrong.append(f"CHANGELOG.md has no section `## {version}`: rename `## Unreleased`")
        if ".invalid" in workspace.package()["repository"]:
            wrong.append("`repository` in Cargo.toml is a placeholder: state the address of the project")
    sys.exit("\n".join(wrong) or None)


if __name__ == "__main__":
    main(*sys.argv[1:])
