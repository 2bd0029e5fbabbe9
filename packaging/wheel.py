#!/usr/bin/env python3
"""Builds the Python wheel for a target, or the source package.

    packaging/wheel.py TARGET FOLDER
    packaging/wheel.py sdist FOLDER

Needs maturin, and for Linux ziglang, whose linker makes wheels for systems with glibc 2.17 (of 2014) and later."""

import pathlib
import subprocess
import sys

import workspace

PYTHON = workspace.ROOT / "python"


def main(target, folder):
    out = ["--out", str(pathlib.Path(folder).resolve())]
    maturin = [sys.executable, "-m", "maturin"]
    if target == "sdist":
        subprocess.run([*maturin, "sdist", *out], cwd=PYTHON, check=True)
        return
    old_glibc = ["--zig", "--compatibility", "manylinux2014"] if "linux" in target else []
    notices = PYTHON / "LICENSE-third-party.txt"
    notices.write_text(workspace.notices("vibroimpact-python", target), "utf-8")
    try:
        words = [*maturin, "build", "--release", "--locked", "--target", target, *old_glibc, *out]
        subprocess.run(words, cwd=PYTHON, env=workspace.environment(target), check=True)
    finally:
        notices.unlink()


if __name__ == "__main__":
    main(*sys.argv[1:])
