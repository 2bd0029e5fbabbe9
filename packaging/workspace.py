"""What cargo says of this workspace, and the surroundings in which it builds for others."""

import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
RUSTC = subprocess.run(["rustc", "-vV"], capture_output=True, text=True, check=True).stdout
# How the files of licences begin.
NAMES = ("LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE")
HOST = RUSTC.split("host: ")[1].split()[0]


def metadata(target=HOST):
    """The answer of `cargo metadata` for a target."""
    words = ["cargo", "metadata", "--format-version", "1", "--locked", "--filter-platform", target]
    return json.loads(subprocess.run(words, cwd=ROOT, capture_output=True, check=True).stdout)


def package(name="vibroimpact"):
    """The metadata of one package of the workspace."""
    return next(p for p in metadata()["packages"] if p["name"] == name and p["source"] is None)


def environment(target):
    """Environment of a build: no symbols and no path of the building machine in the program, and a linker for targets that lack one."""
    home = os.environ.get("CARGO_HOME", str(pathlib.Path.home() / ".cargo"))
    # Not `strip` of the profile: cargo leaves it out for packages that have a profile of their own.
    flags = ["-Cstrip=symbols", f"--remap-path-prefix={home}=cargo", f"--remap-path-prefix={ROOT}=vibroimpact"]
    made = {**os.environ, "CARGO_ENCODED_RUSTFLAGS": "\x1f".join(flags), "CARGO_INCREMENTAL": "0"}
    if target.endswith("-linux-musl"):
        # There is no C in the build, so the toolchain's own linker is enough for every processor.
        made[f"CARGO_TARGET_{target.upper().replace('-', '_')}_LINKER"] = "rust-lld"
    return made


def notices(name, target):
    """Licence texts of all crates of other people in a package built for a target."""
    answer = metadata(target)
    packages = {p["id"]: p for p in answer["packages"]}
    nodes = {node["id"]: node for node in answer["resolve"]["nodes"]}
    found, open_ids = set(), [next(i for i, p in packages.items() if p["name"] == name and p["source"] is None)]
    while open_ids:
        crate = open_ids.pop()
        if crate not in found:
            found.add(crate)
            needed = [d for d in nodes[crate]["deps"] if any(kind["kind"] is None for kind in d["dep_kinds"])]
            open_ids += [d["pkg"] for d in needed]
    licences, crates = {}, sorted((packages[i] for i in found), key=lambda p: (p["name"], p["version"]))
    text = ["Crates of other people in this program, each with its licence, and the licence texts that they carry.\n"]
    for crate in crates:
        name = f"{crate['name']} {crate['version']}"
        if crate["source"] is not None:
            text.append(f"{name}: {crate['license']} {crate['repository'] or ''}")
            for path in sorted(pathlib.Path(crate["manifest_path"]).parent.iterdir()):
                if path.is_file() and path.name.upper().startswith(NAMES):
                    licences.setdefault(path.read_text("utf-8", "replace").strip(), []).append(name)
    for licence, bearers in licences.items():
        text.append(f"\n{'=' * 80}\n{', '.join(bearers)}\n\n{licence}")
    return "\n".join(text) + "\n"


if __name__ == "__main__":
    # The licences in a crate for a target: workspace.py NAME TARGET
    print(notices(*sys.argv[1:]), end="")
