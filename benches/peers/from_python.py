"""The Python package beside others, in one run: seconds of each, medians of several calls.

    python -m venv peers && peers/bin/pip install ./python pyuff polars scipy heyoka
    peers/bin/python benches/peers/from_python.py [FOLDER WITH UFF FILES]

Files of UFF against pyuff, a text of five million lines against NumPy and polars, Welch's spectrum against SciPy, 100 s of scene B against SciPy
and heyoka, and a call on an array against the same on a file by the command. Other programs that are not installed are left out.
"""

import contextlib
import io
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

import numpy as np

import vibroimpact as vi

LINES = 5_000_000
RATE = 1e5


def seconds(call, least=3, most=15, limit=2.0):
    """The median time of a call."""
    took = []
    while len(took) < least or (len(took) < most and sum(took) < limit):
        began = time.perf_counter()
        call()
        took.append(time.perf_counter() - began)
    return median(took)


def row(task, rivals):
    """Prints the times of a task, each with its ratio to ours."""
    own = None
    for name, call in rivals:
        try:
            took = seconds(call)
        except (ImportError, NotImplementedError, ValueError, TypeError, KeyError, OSError) as why:
            print(f"{task:34} {name:28} - ({type(why).__name__})", flush=True)
            continue
        own = own or took
        print(f"{task:34} {name:28} {1e3 * took:10.3f} ms   {took / own:8.2f}", flush=True)


def read_by_pyuff(paths):
    import pyuff

    # It prints what it does not know.
    with contextlib.redirect_stdout(io.StringIO()):
        for path in paths:
            pyuff.UFF(str(path)).read_sets()


def uff(folder):
    """Files of UFF that both read."""
    paths = []
    for path in sorted(folder.iterdir()):
        try:
            vi.read(path)
            read_by_pyuff([path])
            paths.append(path)
        except Exception as why:
            print(f"left out: {path.name} ({type(why).__name__})")
    row(f"UFF, {len(paths)} files", [("vibroimpact", lambda: [vi.read(p) for p in paths]), ("pyuff", lambda: read_by_pyuff(paths))])


def text(folder):
    """A table of time and two channels."""
    t = np.arange(LINES) / RATE
    values = np.column_stack([t, np.sin(t), np.cos(3 * t)])
    path = folder / "long.csv"
    with path.open("w") as file:
        file.write("t [s],a [m],b [m]\n")
        for part in np.array_split(values, 100):
            file.write("\n".join(f"{a:.5f},{b:.6f},{c:.6f}" for a, b, c in part.tolist()) + "\n")

    def polars():
        import polars

        polars.read_csv(path)

    row(
        f"CSV, {LINES // 1_000_000} million lines",
        [
            ("vibroimpact", lambda: vi.read(path)),
            ("NumPy loadtxt", lambda: np.loadtxt(path, delimiter=",", skiprows=1)),
            ("polars", polars),
        ],
    )


def welch():
    """Averaged spectrum of five million samples."""
    x = np.random.default_rng(1).standard_normal(LINES)
    record = vi.Record.of(x, rate=RATE, unit="m/s")

    def scipy():
        from scipy.signal import welch

        welch(x, RATE, "hann", 4096, 2048)

    ours = lambda: vi.spectrum(record, method="welch", segment=4096, overlap=0.5, scaling="psd")  # noqa: E731
    row("Welch, 5 million samples", [("vibroimpact", ours), ("SciPy", scipy)])


def scene_b():
    """100 s of a rig that strikes, from rest."""
    from peers import SCENES, heyoka_integrators, heyoka_motion, scipy_motion

    scene = next(scene for scene in SCENES if scene.name == "scene B, 100 s")
    frequency = scene.omega / (2 * np.pi)
    rig = vi.Rig(m1=0.125, m2=0.094, k1=135.0, k2=128.0, c1=0.1, c2=0.1, gap=scene.gap, restitution=0.7)
    cycles = int(scene.until * frequency)

    def heyoka():
        heyoka_motion(scene, 1e-12, heyoka_integrators(scene, 1e-12))

    row(
        "scene B, 100 s",
        [
            ("vibroimpact", lambda: rig.simulate(force=scene.force, frequency=frequency, cycles=cycles, settle=0)),
            ("SciPy DOP853 1e-9", lambda: scipy_motion(scene, "DOP853", 1e-9)),
            ("heyoka 1e-12", heyoka),
        ],
    )


def overhead(folder):
    """A decay of 200 000 samples: an array, a file, and the file by the command."""
    t = np.arange(200_000) / 2e4
    x = np.exp(-2.0 * t) * np.cos(300 * t) + 1e-4 * np.random.default_rng(2).standard_normal(t.size)
    record = vi.Record.of(x, rate=2e4, unit="m/s", name="v")
    path = folder / "decay.ufb"
    vi.write_uff(path, record)
    command = [Path(sys.executable).with_name("vibro"), "decay", path, "--json"]
    row(
        "decay, 200 000 samples",
        [
            ("vibroimpact, array", lambda: vi.decay(record)),
            ("vibroimpact, file", lambda: vi.decay(path)),
            ("command of the wheel", lambda: subprocess.run(command, capture_output=True, check=True)),
        ],
    )
    row("a rig's orbits", [("vibroimpact", lambda: vi.Rig().orbits(frequency=11.2, force=0.5))])
    start = [sys.executable, "-c", "import vibroimpact"]
    row("import, whole process", [("vibroimpact", lambda: subprocess.run(start, check=True)), ("NumPy", lambda: subprocess.run([*start[:2], "import numpy"], check=True))])


def main():
    print(f"{'task':34} {'program':28} {'median':>13}   over ours")
    if len(sys.argv) > 1:
        uff(Path(sys.argv[1]))
    with tempfile.TemporaryDirectory() as folder:
        overhead(Path(folder))
        welch()
        text(Path(folder))
    scene_b()


if __name__ == "__main__":
    main()
