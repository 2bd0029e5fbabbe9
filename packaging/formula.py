#!/usr/bin/env python3
"""Writes SHA256SUMS of the archives and wheels in a folder, and the formula of Homebrew with the sums of its archives.

    packaging/formula.py FOLDER [--partial]

With --partial archives may be missing, as where only those of Linux were built; their sums stay open in the formula."""

import hashlib
import pathlib
import re
import sys

import workspace


def main(folder, *options):
    folder, package = pathlib.Path(folder), workspace.package()
    packed = sorted(path for path in folder.iterdir() if path.name.endswith((".tar.gz", ".zip", ".whl")))
    sums = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in packed}
    (folder / "SHA256SUMS").write_text("".join(f"{digest}  {name}\n" for name, digest in sums.items()))
    known = {"version": package["version"], "repository": package["repository"]}
    for name, digest in sums.items():
        if archive := re.fullmatch(rf"vibro-{re.escape(package['version'])}-(.+)\.tar\.gz", name):
            known[archive[1]] = digest
    template = (workspace.ROOT / "packaging/vibro.rb").read_text().split("\n", 1)[1]
    filled = re.sub(r"@([\w-]+)@", lambda name: known.get(name[1], name[0]), template)
    missing = re.findall(r"@([\w-]+)@", filled)
    if missing and "--partial" not in options:
        sys.exit(f"{folder} lacks the archives of {', '.join(missing)}")
    (folder / "vibro.rb").write_text(filled)


if __name__ == "__main__":
    main(*sys.argv[1:])
