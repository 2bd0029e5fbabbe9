"""MAT-files with structs and cell arrays in each other, and such of level 4, written by scipy, read by `vibro` and by scipy: every value must be equal.

    python -m venv peers && peers/bin/pip install numpy scipy
    peers/bin/python benches/peers/mat.py target/release/vibro

Writes its files into a folder that it removes, says where values differ, and then how long both take for a file of 64 MB.
"""

import json
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.io import loadmat, savemat
from whole_process import fastest

KINDS = ["f8", "f4", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"]


def values(draw, n):
    kind = draw.choice(KINDS)
    if kind[0] == "f":
        out = np.array([draw.gauss(0, 40) for _ in range(n)], kind)
    else:
        ends = np.iinfo(kind)
        out = np.array([draw.randrange(max(ends.min, -(10**6)), min(ends.max, 10**6)) for _ in range(n)], kind)
    return out.reshape(draw.choice([(n, 1), (1, n)]))


def some(draw, depth):
    """A vector, a matrix, a text, a scalar, an empty array, a struct, a struct array or a cell array."""
    what = draw.randrange(6 if depth > 3 else 12)
    if what < 3:
        return values(draw, draw.randrange(2, 40))
    if what == 3:
        rows = draw.randrange(2, 20)
        return values(draw, rows * 3).reshape(rows, 3, order="F")
    if what == 4:
        return draw.choice(["text", draw.gauss(0, 1), np.zeros((0, 0))])
    if what == 5:
        n = draw.randrange(2, 20)
        return values(draw, n) * 1.0 + 1j * values(draw, n).reshape(-1)[0]
    names = [f"f{i}_{draw.randrange(100)}" for i in range(draw.randrange(1, 4))]
    if what < 9:
        return {name: some(draw, depth + 1) for name in names}
    n = draw.randrange(1, 4)
    if what < 11:
        cells = np.empty((1, n), object)
        for i in range(n):
            cells[0, i] = some(draw, depth + 1)
        return cells
    structs = np.empty((n, 1), [(name, object) for name in names])
    for i in range(n):
        for name in names:
            structs[i, 0][name] = some(draw, depth + 1)
    return structs


def leaves(name, value, out):
    """Vectors below a value that scipy read, under the names that MATLAB gives them."""
    flat = value.reshape(-1, order="F")
    if value.dtype.names:
        for i, one in enumerate(flat):
            for field in value.dtype.names:
                leaves(f"{name}({i + 1}).{field}" if len(flat) > 1 else f"{name}.{field}", one[field], out)
    elif value.dtype == object:
        for i, one in enumerate(flat):
            leaves(f"{name}{{{i + 1}}}", one, out)
    elif value.dtype.kind in "fiuc" and value.size > 1:
        if min(value.shape) == 1:
            out[name] = flat
        else:
            out |= {f"{name}(:,{k + 1})": value[:, k] for k in range(value.shape[1])}


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def read(vibro, path, folder):
    """Values of each record as `vibro` reads them, in the file's order, by way of binary UFF."""
    names = [r["name"] for r in json.loads(run(vibro, "info", str(path), "--json"))["files"][0]["records"]]
    copy = folder / "out.uff"
    run(vibro, "convert", str(path), str(copy), "--binary")
    data, out, at = copy.read_bytes(), {}, 0
    for name in names:
        at = data.index(b"    58b", at)
        head = data[at:].split(b"\n", 12)[:12]
        kind, n = (int(word) for word in head[7].split()[:2])
        at += sum(len(line) + 1 for line in head)
        dtype = {4: "<f8", 6: "<c16"}[kind]
        out[name] = np.frombuffer(data, dtype, n, at)
        at += out[name].nbytes
    return out


def main():
    vibro = sys.argv[1]
    wrong = records = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path = folder / "x.mat"
        files = int(sys.argv[2]) if len(sys.argv) > 2 else 300
        for seed in range(files):
            draw = random.Random(seed)
            written = {f"v{i}": some(draw, 0) for i in range(3)} | {"last": values(draw, 5)}
            if seed % 3:
                savemat(path, written, do_compression=draw.random() < 0.5, long_field_names=draw.random() < 0.5)
            else:
                savemat(path, {f"v{i}": some(draw, 4) for i in range(5)} | {"last": written["last"]}, format="4")
            theirs = {}
            for key, value in loadmat(path).items():
                if not key.startswith("__"):
                    leaves(key, value, theirs)
            ours = read(vibro, path, folder)
            records += len(theirs)
            if list(ours) != list(theirs):
                wrong += 1
                print(f"file {seed}: {list(theirs)} and {list(ours)}")
            for key in theirs.keys() & ours.keys():
                if not np.array_equal(np.asarray(theirs[key], ours[key].dtype), ours[key]):
                    wrong += 1
                    print(f"file {seed}, {key}: {theirs[key][:4]} and {ours[key][:4]}")
        print(f"{files} files, {records} records, {wrong} differ")
        n = 1 << 21
        channels = {f"c{i}": v for i, v in enumerate(np.random.default_rng(1).normal(size=(4, n)))}
        savemat(path, {"run": channels | {"fs": 1e5}})
        program = f"from scipy.io import loadmat\nr = loadmat({str(path)!r})['run'][0, 0]\nfor i in range(4): r[f'c{{i}}'].max()"
        for command in ([vibro, "info", str(path)], [sys.executable, "-c", program]):
            print(f"{fastest(command):.0f} ms", *command[:2])
    sys.exit(wrong > 0)


main()
