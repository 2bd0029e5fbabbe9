#!/usr/bin/env python3
"""Builds `vibro` for a target and packs it with licences, manual page and completions.

    packaging/archive.py TARGET FOLDER [VIBRO]

VIBRO is a `vibro` that runs on this machine; it prints manual page and completions where the one for TARGET cannot run.
The same sources and toolchain give the same bytes."""

import gzip
import io
import pathlib
import subprocess
import sys
import tarfile
import zipfile

import workspace

COMPLETIONS = {"bash": "vibro.bash", "zsh": "_vibro", "fish": "vibro.fish", "powershell": "_vibro.ps1"}
# What the archive has of the repository: its name there, its name here.
FILES = {
    "README.md": "README.md",
    "CHANGELOG.md": "CHANGELOG.md",
    "LICENSE-MIT": "LICENSE-MIT",
    "LICENSE-APACHE": "LICENSE-APACHE",
    "LICENSE-DejaVu.txt": "crates/vibro-figure/src/assets/LICENSE-DejaVu.txt",
    "LICENSE-uPlot.txt": "src/report/assets/page/LICENSE-uPlot.txt",
}


def built(target):
    """The path of the program, after it was built."""
    words = ["cargo", "build", "--release", "--locked", "--package", "vibroimpact", "--bin", "vibro", "--target", target]
    subprocess.run(words, cwd=workspace.ROOT, env=workspace.environment(target), check=True)
    folder = pathlib.Path(workspace.metadata()["target_directory"]) / target / "release"
    return folder / ("vibro.exe" if "windows" in target else "vibro")


def contents(program, speaker, target):
    """Names in the archive with their bytes."""
    def said(*words):
        return subprocess.run([speaker, *words], capture_output=True, check=True).stdout

    files = {program.name: program.read_bytes()}
    files |= {name: (workspace.ROOT / path).read_bytes() for name, path in FILES.items()}
    files["LICENSE-third-party.txt"] = workspace.notices("vibroimpact", target).encode()
    files["man/vibro.1"] = said("man")
    files |= {f"completions/{name}": said("completions", shell) for shell, name in COMPLETIONS.items()}
    return files


def packed(files, stem, folder, ending):
    """Writes the archive; times and owners are left out, so that equal files are equal archives."""
    path = folder / f"{stem}{ending}"
    if ending == ".zip":
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
            for name, data in sorted(files.items()):
                archive.writestr(zipfile.ZipInfo(f"{stem}/{name}"), data, zipfile.ZIP_DEFLATED)
        return path
    with open(path, "wb") as raw, gzip.GzipFile("", "wb", 9, raw, 0) as packer, tarfile.open(fileobj=packer, mode="w") as archive:
        for name, data in sorted(files.items()):
            entry = tarfile.TarInfo(f"{stem}/{name}")
            entry.size, entry.mode = len(data), 0o755 if name == "vibro" else 0o644
            archive.addfile(entry, io.BytesIO(data))
    return path


def main(target, folder, speaker=None):
    program = built(target)
    stem = f"vibro-{workspace.package()['version']}-{target}"
    files = contents(program, speaker or program, target)
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    path = packed(files, stem, folder, ".zip" if "windows" in target else ".tar.gz")
    print(f"{path}: {path.stat().st_size / 1e6:.1f} MB, vibro {len(files[program.name]) / 1e6:.1f} MB")


if __name__ == "__main__":
    main(*sys.argv[1:])
