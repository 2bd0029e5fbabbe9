"""Packs the module, what unpacks it, and the parts of the page into one file: pack.py MODULE UNPACKER PAGE"""
import base64
import gzip
import lzma
import sys
from pathlib import Path

HERE = Path(__file__).parent / "page"
SCRIPTS = ["module.js", "files.js", "list.js", "tables.js", "trace.js", "campaign.js", "app.js"]


def as_text(data: bytes) -> str:
    """Four bytes as five characters. A comma stands for <, which would be read as markup."""
    return base64.b85encode(data, pad=True).decode().replace("<", ",")


def main(module: str, unpacker: str, page: str) -> None:
    wasm = Path(module).read_bytes()
    packed = lzma.compress(wasm, lzma.FORMAT_ALONE, preset=9 | lzma.PRESET_EXTREME)
    first = gzip.compress(Path(unpacker).read_bytes(), 9, mtime=0)
    parts = {
        "STYLE": (HERE / "app.css").read_text(encoding="utf-8"),
        "WORKER": (HERE / "worker.js").read_text(encoding="utf-8"),
        "SCRIPTS": "\n".join((HERE / name).read_text(encoding="utf-8") for name in SCRIPTS),
        "UNPACKER": as_text(first),
        "UNPACKER_BYTES": str(len(first)),
        "MODULE": as_text(packed),
        "MODULE_BYTES": str(len(packed)),
        "UNPACKED_BYTES": str(len(wasm)),
    }
    text = (HERE / "app.html").read_text(encoding="utf-8")
    for name, part in parts.items():
        text = text.replace("{{" + name + "}}", part)
    out = Path(page)
    new = out.with_suffix(".part")
    new.write_text(text, encoding="utf-8", newline="\n")
    new.replace(out)
    print(f"{out.name}: {len(text) / 1e6:.2f} MB, of which the module is {len(parts['MODULE']) / 1e6:.2f} MB")


main(*sys.argv[1:])
