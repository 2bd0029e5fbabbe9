"""HDF5 and MAT v7.3 files of many kinds, read by `vibro` and by h5py: every value must be equal.

    python -m venv peers && peers/bin/pip install numpy h5py hdf5storage
    peers/bin/python benches/peers/hdf5.py target/release/vibro

Writes its files into a folder that it removes, says where values differ, and then how long both take for files of 64 MB.
"""

import json
import random
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

import h5py
import hdf5storage
import numpy as np
from whole_process import fastest

KINDS = ["i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", "f4", "f8", "c8", "c16"]
UNITS = {"m": 1.0, "mm/s": 1e-3, "kN": 1e3, "µm": 1e-6, "V": 1.0}
FILTERS = [{}, {"compression": "gzip"}, {"compression": "lzf"}, {"fletcher32": True}, {"shuffle": True, "compression": "gzip", "compression_opts": 9}]


def numbers(rng, kind, shape):
    kind = np.dtype(kind)
    if kind.kind == "c":
        return (rng.normal(size=shape) + 1j * rng.normal(size=shape)).astype(kind)
    if kind.kind == "f":
        return (rng.normal(size=shape) * 40).astype(kind)
    ends = np.iinfo(kind)
    return rng.integers(ends.min, ends.max, shape, dtype=kind.newbyteorder("="), endpoint=True).astype(kind)


def columns(name, values):
    """The records of a dataset: the longer dimension is the samples."""
    if values.ndim == 1:
        return {name: values}
    if values.shape[1] > values.shape[0]:
        return {f"{name}[{k},:]": row for k, row in enumerate(values)}
    return {f"{name}[:,{k}]": column for k, column in enumerate(values.T)}


def state(draw, rng, attributes):
    """Writes unit and rate as attributes; gives factor and step."""
    factor, step = 1.0, None
    if draw.random() < 0.5:
        unit, factor = draw.choice(list(UNITS.items()))
        attributes[draw.choice(["unit", "units", "YUnits"])] = draw.choice([unit, [unit], np.bytes_(unit.encode())])
    if draw.random() < 0.5:
        kind = draw.choice(["f4", "f8", ">f8", "i4", "u2"])
        rate = np.dtype(kind).type(draw.choice([100, 1000, 51200]))
        name, value = draw.choice([("fs", rate), ("sample_rate", rate), ("dt", np.float64(1 / float(rate)))])
        attributes[name] = draw.choice([value, np.array([value])])
        step = 1 / float(rate)
    return factor, step


def some_h5(draw, path):
    """Expected values, SI, and step of each record by its name."""
    rng, expected = np.random.default_rng(draw.randrange(10**9)), {}
    bound = draw.choice(["earliest", "v108", "v110", "latest"])
    libver = ("earliest", "v108") if bound == "earliest" else (bound, "latest")
    with h5py.File(path, "w", libver=libver, userblock_size=draw.choice([0, 512, 2048]), track_order=draw.random() < 0.3) as f:
        for i in range(draw.randrange(1, 12)):
            group = draw.choice(["", "", "run 1", "a/b/c"])
            place = f.require_group(group) if group else f
            name = f"{group}/x{i}".lstrip("/")
            shape = (draw.randrange(2, 400),) if draw.random() < 0.6 else draw.choice([(40, 3), (4, 50), (90, 7)])
            kind = draw.choice("<>") + draw.choice(KINDS)
            if draw.random() < 0.1:
                values = numbers(rng, "f8", shape[:1])
                table = np.zeros(shape[0], np.dtype([("u", "<f8"), ("k", ">i2"), ("w", "<f4")], align=draw.random() < 0.5))
                table["u"], table["k"], table["w"] = values, numbers(rng, "i2", shape[0]), values
                dataset = place.create_dataset(f"x{i}", data=table, chunks=draw.choice([None, (2,)]))
                found = {f"{name}/{field}": table[field] for field in table.dtype.names}
            else:
                values, options = numbers(rng, kind, shape), {}
                if draw.random() < 0.7:
                    chunk = tuple(draw.randrange(1, n + 1) for n in shape)
                    growing = tuple(draw.choice([n, None]) for n in shape)
                    options = {"chunks": chunk, "maxshape": growing} | draw.choice(FILTERS)
                    if np.dtype(kind).kind in "iu" and draw.random() < 0.1:
                        options = {"chunks": chunk, "scaleoffset": 0}
                if draw.random() < 0.2 and "scaleoffset" not in options:
                    dataset = place.create_dataset(f"x{i}", shape, kind, fillvalue=values.flat[0], **options)
                    rows = draw.randrange(shape[0])
                    dataset[:rows] = values[:rows]
                else:
                    dataset = place.create_dataset(f"x{i}", data=values, **options)
                found = columns(name, dataset[...])
            for extra in range(draw.choice([0, 0, 0, 20])):
                dataset.attrs[f"extra {extra}"] = draw.choice([1.5, "text", True, np.arange(3)])
            factor, step = state(draw, rng, dataset.attrs)
            expected |= {key: (v.astype("c16" if v.dtype.kind == "c" else "f8") * factor, step) for key, v in found.items()}
        if draw.random() < 0.3:
            f["link"], f["outside"] = h5py.SoftLink("/nowhere"), h5py.ExternalLink("other.h5", "/x")
    return expected


def some_value(draw, rng, name, expected, depth):
    """A value of MATLAB, whose records are added to `expected`."""
    pick = draw.random()
    if depth < 3 and pick < 0.2:
        return {f"f{i}": some_value(draw, rng, f"{name}.f{i}", expected, depth + 1) for i in range(draw.randrange(1, 4))}
    if depth < 3 and pick < 0.35:
        cell = np.empty(draw.randrange(2, 4), object)
        cell[:] = [some_value(draw, rng, f"{name}{{{i + 1}}}", expected, depth + 1) for i in range(len(cell))]
        return cell
    if pick < 0.45:
        return draw.choice(["text", 1.5, np.zeros((0, 3)), np.array([True, False])])
    kind = draw.choice(KINDS)
    values = numbers(rng, kind, draw.choice([draw.randrange(2, 200), (30, 3)]))
    wide = values.astype("c16" if kind[0] == "c" else "f8")
    expected |= {name: (wide, None)} if wide.ndim == 1 else {f"{name}(:,{k + 1})": (c, None) for k, c in enumerate(wide.T)}
    return values


def some_mat(draw, path):
    rng, expected = np.random.default_rng(draw.randrange(10**9)), {}
    content = {f"v{i}": some_value(draw, rng, f"v{i}", expected, 0) for i in range(draw.randrange(1, 6))}
    path.unlink(missing_ok=True)
    hdf5storage.write(content, filename=str(path), matlab_compatible=True)
    return expected


def data_sets(path):
    """The values of each data set 58b."""
    rest = path.read_bytes()
    while rest.strip():
        head = rest.split(b"\n", 13)
        size, kind = int(head[1].split()[4]), int(head[8].split()[0])
        yield np.frombuffer(head[13], {4: "<f8", 6: "<c16"}[kind], size // (8 if kind == 4 else 16))
        rest = head[13][size:].split(b"\n", 1)[1]


def differences(vibro, path, folder, expected):
    said = subprocess.run([vibro, "info", "--json", str(path)], capture_output=True, text=True)
    if not expected:
        return [] if said.returncode else ["nothing expected, something read"]
    if said.returncode:
        return [said.stderr]
    records = {record["name"]: record for record in json.loads(said.stdout)["files"][0]["records"]}
    subprocess.run([vibro, "convert", str(path), str(folder / "x.uff"), "--binary"], check=True, capture_output=True)
    found = dict(zip(records, data_sets(folder / "x.uff"), strict=True))
    wrong = [f"only in one: {name}" for name in found.keys() ^ expected.keys()]
    for name in found.keys() & expected.keys():
        values, step = expected[name]
        # A unit's factor rounds once here and once there.
        if len(found[name]) != len(values) or np.any(np.abs(found[name] - values) > 4e-16 * np.abs(values)):
            wrong.append(f"{name}: {found[name][:4]} for {values[:4]}")
        if step and values.dtype.kind != "c" and abs(records[name]["dx"] / step - 1) > 1e-12:
            wrong.append(f"{name}: step {records[name]['dx']} for {step}")
    return wrong


def main():
    warnings.simplefilter("ignore")
    vibro = sys.argv[1]
    files = int(sys.argv[2]) if len(sys.argv) > 2 else 300
    failed = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for write, ending in ((some_h5, "h5"), (some_mat, "mat")):
            records = wrong = 0
            for seed in range(files):
                path = folder / f"x.{ending}"
                expected = write(random.Random(seed), path)
                records += len(expected)
                found = differences(vibro, path, folder, expected)
                wrong += len(found)
                for line in found:
                    print(f"{ending} {seed}: {line}")
            print(f"{files} files .{ending}: {records} records, {wrong} differ")
            failed += wrong
        values = np.round(np.random.default_rng(1).normal(size=1 << 23) * 1000) / 1000
        for what, options in {"contiguous": {}, "gzip": {"chunks": True, "compression": "gzip", "shuffle": True}}.items():
            path = folder / f"{what}.h5"
            with h5py.File(path, "w") as f:
                f.create_dataset("x", data=values, **options).attrs["fs"] = 1000.0
            program = f"import h5py\nwith h5py.File({str(path)!r}) as f: f['x'][()].max()"
            ours, theirs = fastest([vibro, "info", str(path)]), fastest([sys.executable, "-c", program])
            print(f"{what}, 64 MB: vibro info {ours:.0f} ms, h5py {theirs:.0f} ms")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
