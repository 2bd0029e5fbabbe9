"""TDMS files of many kinds, read by `vibro` and by npTDMS: every value must be equal.

    python -m venv peers && peers/bin/pip install numpy npTDMS
    peers/bin/python benches/peers/tdms.py target/release/vibro

Writes its files into a folder that it removes, says where values differ, and then how long both take for a file of 64 MB.
"""

import random
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from nptdms import TdmsFile
from whole_process import fastest

META, NEW, RAW, MIXED, BIG = 2, 4, 8, 32, 64
TYPES = {1: "i1", 2: "i2", 3: "i4", 4: "i8", 5: "u1", 6: "u2", 7: "u4", 8: "u8", 9: "f4", 10: "f8"}
DAQMX = ["u1", "i1", "u2", "i2", "u4", "i4"]


def text(order, value):
    value = value.encode()
    return struct.pack(order + "I", len(value)) + value


def properties(order, values):
    out = struct.pack(order + "I", len(values))
    for key, value in values.items():
        out += text(order, key)
        if isinstance(value, str):
            out += struct.pack(order + "I", 0x20) + text(order, value)
        elif isinstance(value, int):
            out += struct.pack(order + "II", 7, value)
        else:
            out += struct.pack(order + "Id", 10, value)
    return out


def segment(order, contents, objects, raw):
    meta = b""
    if contents & META:
        meta = struct.pack(order + "I", len(objects))
        meta += b"".join(text(order, path) + index + properties(order, values) for path, index, values in objects)
    contents |= BIG if order == ">" else 0
    lead = b"TDSm" + struct.pack("<I", contents) + struct.pack(order + "IQQ", 4713, len(meta) + len(raw), len(meta))
    return lead + meta + raw


def plain(order, code, n):
    return struct.pack(order + "IIIQ", 20, code, 1, n)


def daqmx(order, n, scalers, widths):
    out = struct.pack(order + "IIIQI", 0x1269, 0xFFFFFFFF, 1, n, len(scalers))
    for code, buffer, offset, scale in scalers:
        out += struct.pack(order + "IIIII", code, buffer, offset, 0, scale)
    return out + struct.pack(order + "I", len(widths)) + struct.pack(order + f"{len(widths)}I", *widths)


def scales(draw):
    """A chain of one to three scales, or none."""
    n = draw.randrange(4)
    out = {"NI_Number_Of_Scales": n, "NI_Scaling_Status": draw.choice(["scaled", "unscaled"])} if n else {}
    for i in range(n):
        name = f"NI_Scale[{i}]_"
        source = draw.choice([0xFFFFFFFF] + list(range(i)))
        kind = draw.choice(["Linear", "Polynomial", "Table", "Add", "Subtract"] if i else ["Linear", "Polynomial"])
        out[name + "Scale_Type"] = kind
        if kind == "Linear":
            out |= {name + "Linear_Slope": draw.gauss(0, 3), name + "Linear_Y_Intercept": draw.gauss(0, 3)}
        elif kind == "Polynomial":
            c = [draw.gauss(0, 1) for _ in range(draw.randrange(1, 6))]
            out[name + "Polynomial_Coefficients_Size"] = len(c)
            out |= {f"{name}Polynomial_Coefficients[{j}]": v for j, v in enumerate(c)}
        elif kind == "Table":
            steps = sorted(draw.gauss(0, 50) for _ in range(draw.randrange(2, 7)))[:: draw.choice([1, -1])]
            out |= {name + "Table_Scaled_Values_Size": len(steps), name + "Table_Pre_Scaled_Values_Size": len(steps)}
            out |= {f"{name}Table_Pre_Scaled_Values[{j}]": v for j, v in enumerate(steps)}
            out |= {f"{name}Table_Scaled_Values[{j}]": draw.gauss(0, 9) for j in range(len(steps))}
        else:
            # Not of raw integers: npTDMS adds those in their own type, where they overflow.
            out |= {f"{name}{kind}_{side}_Operand_Input_Source": draw.choice(range(i)) for side in ("Left", "Right")}
        if kind not in ("Add", "Subtract"):
            out[f"{name}{kind}_Input_Source"] = source
    return out


def numbers(draw, kind, n):
    if kind[0] == "f":
        return np.array([draw.gauss(0, 40) for _ in range(n)], kind)
    ends = np.iinfo(kind)
    span = min(ends.max, 10**6)
    return np.array([draw.randrange(max(ends.min, -span), span) for _ in range(n)], kind)


def some_file(draw):
    order, layout = draw.choice("<>"), draw.choice(["plain", "mixed", "daqmx"])
    channels, n, chunks = draw.randrange(1, 5), draw.randrange(1, 40), draw.randrange(1, 4)
    out = b""
    names = [f"/'group'/'ch {i}'" for i in range(channels)]
    if layout == "daqmx":
        buffers = draw.randrange(1, 3)
        widths, scalers = [0] * buffers, []
        for i in range(channels):
            code, buffer = draw.randrange(len(DAQMX)), i % buffers
            scalers.append((code, buffer, widths[buffer], 0))
            widths[buffer] += np.dtype(DAQMX[code]).itemsize
        buffers = [w for w in widths if w]
        objects = []
        for name, scaler in zip(names, scalers):
            chain = {"NI_Number_Of_Scales": 2, "NI_Scale[1]_Scale_Type": "Linear", "NI_Scale[1]_Linear_Slope": draw.gauss(0, 2)}
            chain |= {"NI_Scale[1]_Linear_Y_Intercept": draw.gauss(0, 2), "NI_Scale[1]_Linear_Input_Source": 0}
            objects.append((name, daqmx(order, n, [scaler], widths[: len(buffers)]), chain))
        raw = bytes(draw.randrange(256) for _ in range(n * chunks * sum(buffers)))
        return out + segment(order, META | NEW | RAW, objects, raw)
    codes = [draw.choice(list(TYPES)) for _ in range(channels)]
    for part in range(draw.randrange(1, 4)):
        raw = b""
        for _ in range(chunks):
            values = [numbers(draw, TYPES[code], n).astype(order + TYPES[code]) for code in codes]
            if layout == "plain":
                raw += b"".join(v.tobytes() for v in values)
            else:
                raw += b"".join(v[i : i + 1].tobytes() for i in range(n) for v in values)
        flags = RAW | (MIXED if layout == "mixed" else 0)
        if part == 0:
            chain = [scales(draw) | {"wf_increment": 0.25} for _ in names]
            objects = [(name, plain(order, code, n), p) for name, code, p in zip(names, codes, chain)]
            out += segment(order, META | NEW | flags, objects, raw)
        elif draw.random() < 0.5:
            out += segment(order, flags, [], raw)
        else:
            objects = [(name, struct.pack(order + "I", 0), {}) for name in names]
            out += segment(order, META | flags, objects, raw)
    return out


def read(vibro, path, folder):
    """Values of each channel as `vibro` reads them."""
    table = folder / "out.csv"
    subprocess.run([vibro, "convert", str(path), str(table)], check=True, capture_output=True)
    return np.genfromtxt(table, delimiter=",", comments="#", names=True, deletechars="", replace_space=" ")


def main():
    vibro = sys.argv[1]
    wrong = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path = folder / "x.tdms"
        files = int(sys.argv[2]) if len(sys.argv) > 2 else 300
        for seed in range(files):
            path.write_bytes(some_file(random.Random(seed)))
            found = read(vibro, path, folder)
            columns = found.dtype.names[1:]
            for channel, column in zip(TdmsFile.read(path)["group"].channels(), columns):
                theirs, ours = np.asarray(channel[:], float), np.atleast_1d(found[column])
                # npTDMS scales single precision in single precision.
                close = 1e-5 if channel.data_type.__name__ == "SingleFloat" else 1e-14
                size = np.max(np.abs(theirs)) if len(theirs) else 0.0
                if len(theirs) != len(ours) or np.max(np.abs(theirs - ours)) > close * size:
                    wrong += 1
                    print(f"file {seed}, {channel.name}: {theirs[:4]} and {ours[:4]}")
        print(f"{files} files, {wrong} channels differ")
        n = 1 << 21
        objects = [(f"/'g'/'{i}'", plain("<", 10, n), {"wf_increment": 1e-5}) for i in range(4)]
        path.write_bytes(segment("<", META | NEW | RAW, objects, np.random.default_rng(1).normal(size=4 * n).tobytes()))
        program = f"from nptdms import TdmsFile\nfor c in TdmsFile.read({str(path)!r})['g'].channels(): c[:].max()"
        for command in ([vibro, "info", str(path)], [sys.executable, "-c", program]):
            print(f"{fastest(command):.0f} ms", *command[:2])
    sys.exit(wrong > 0)


main()
