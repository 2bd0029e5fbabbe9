#!/usr/bin/env python3
"""Uses what a release would bring to this machine: unpacks the archive, installs the wheel, runs an example with each.

    packaging/smoke.py FOLDER

The program for the other processor of Linux runs where qemu-aarch64-static is installed."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import venv

import workspace


def example(words, folder):
    """Runs the example bench and checks the frequency of its mode, which is 60 Hz."""
    subprocess.run([*words, "demo", "bench", "--out", folder], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
    results = json.loads((folder / "results/results.json").read_text("utf-8"))
    frequency = results["decays"][0]["modes"][0]["frequency"]["value"]
    assert abs(frequency - 60) < 0.1, frequency
    print(f"{words[-1]}: example bench, {frequency:.4f} Hz of 60 Hz")


def archives(folder):
    """Targets whose program runs here, with what runs it."""
    here = workspace.HOST.replace("-linux-gnu", "-linux-musl")
    emulator = shutil.which("qemu-aarch64-static")
    runners = {here: [], "aarch64-unknown-linux-musl": [emulator] if emulator else None} | {here: []}
    for target, runner in runners.items():
        for path in folder.glob(f"vibro-*-{target}.*"):
            if runner is not None:
                yield path, runner


def main(folder):
    folder = pathlib.Path(folder).resolve()
    with tempfile.TemporaryDirectory() as work:
        work = pathlib.Path(work)
        for path, runner in archives(folder):
            shutil.unpack_archive(path, work)
            stem = path.name.removesuffix(".zip").removesuffix(".tar.gz")
            program = next(p for p in (work / stem).iterdir() if p.stem == "vibro")
            example([*runner, str(program)], work / f"with-{stem}")
        venv.create(work / "env", with_pip=True)
        programs = work / "env" / ("Scripts" if os.name == "nt" else "bin")
        version = workspace.package()["version"]
        words = ["install", "--quiet", "--find-links", str(folder), "--only-binary", "vibroimpact", f"vibroimpact=={version}"]
        subprocess.run([programs / "python", "-m", "pip", "--disable-pip-version-check", *words], check=True)
        subprocess.run([programs / "python", "-c", "import vibroimpact; print(vibroimpact.__version__)"], cwd=work, check=True)
        example([str(programs / "vibro")], work / "with-wheel")


if __name__ == "__main__":
    main(*sys.argv[1:])
