"""Scenes of the estimators of `vibro precision` in other programs: writes the lines that `vibro precision --add FILE` takes.

    benches/peers/precision.sh precision

installs the other programs, measures them and vibro in one run, and draws both. This file alone, with numpy, SciPy, pyFRF, sdypy-EMA and pyOMA_2 installed:

    cargo run --release -p vibro-precision --example records -- FOLDER
    python benches/peers/estimators.py FOLDER peers.json [vibro.json]

All methods get the very records that vibro gets. With vibro.json, the output of `vibro precision --family estimators --json`, a table of both is printed (Markdown): errors by setting, in the
unit of the scene, the time in units of that of vibro's last method on the same records, and the number of records without an answer.
"""

import contextlib
import io
import json
import logging
import math
import os
import sys
import time
import warnings
from importlib.metadata import version

os.environ["TQDM_DISABLE"] = "1"  # progress bars of the other programs
import numpy as np
from scipy import integrate, optimize, signal

TIMED = 24  # records of a setting that are timed, as in `vibro precision`


def parabola(lines, k):
    """Place of the maximum of a parabola through line k and its neighbours."""
    if not 0 < k < len(lines) - 1:
        return float(k)
    left, middle, right = lines[k - 1 : k + 2]
    return k - 0.5 * (right - left) / (left + right - 2 * middle)


def periodogram(r, window):
    """Frequencies and peak amplitudes."""
    f, power = signal.periodogram(r.values, 1 / r.step, window=window, scaling="spectrum", detrend=False)
    return f, np.sqrt(2 * power)


def largest_line(r):
    f, a = periodogram(r, "boxcar")
    return f[np.argmax(a)]


def hann_parabola(r):
    f, a = periodogram(r, "hann")
    return parabola(a, np.argmax(a)) * f[1]


def sine(t, a, b, f):
    return a * np.cos(2 * math.pi * f * t) + b * np.sin(2 * math.pi * f * t)


def quadratures(r, f):
    """Cosine and sine of a frequency by projection, to start a fit from."""
    z = 2 * np.mean(r.values * np.exp(-2j * math.pi * f * r.times))
    return [z.real, -z.imag]


def fitted_sine(r):
    f = hann_parabola(r)
    return optimize.curve_fit(sine, r.times, r.values, [*quadratures(r, f), f])[0]


def second_peak(r):
    """Places in Hz of the two highest peaks of the Hann periodogram."""
    f, a = periodogram(r, "hann")
    peaks = sorted(signal.find_peaks(a)[0], key=lambda k: -a[k])[:2]
    if len(peaks) < 2:
        raise ValueError("one peak only")
    return [parabola(a, k) * f[1] for k in peaks]


def fitted_pair(r):
    start = [part for f in second_peak(r) for part in [*quadratures(r, f), f]]
    p = optimize.curve_fit(lambda t, *p: sine(t, *p[:3]) + sine(t, *p[3:]), r.times, r.values, start)[0]
    return min((math.hypot(*p[i : i + 2]), p[i + 2]) for i in (0, 3))[1]


def integrated(r):
    """Cumulative trapezoids without the mean, a Butterworth high-pass at half the known frequency, and the RMS of the middle half."""
    moved = integrate.cumulative_trapezoid(r.values - r.values.mean(), dx=r.step, initial=0)
    passed = signal.sosfiltfilt(signal.butter(4, 0.5 * r.known, "high", fs=1 / r.step, output="sos"), moved)
    quarter = len(passed) // 4
    return math.sqrt(2) * passed[quarter:-quarter].std()


def half_power(f, h):
    """Width of the largest peak at half its power, by scipy.signal.peak_widths."""
    power = np.abs(h) ** 2
    k = int(np.argmax(power))
    return signal.peak_widths(power, [k], rel_height=0.5)[0][0] * (f[1] - f[0]) / (2 * f[k])


def one_mode(r):
    """Receptance of a mode with a complex constant and a constant residual."""
    f, h = r.frequencies, r.complex
    k = int(np.argmax(np.abs(h)))

    def residual(p):
        model = (p[2] + 1j * p[3]) / (1 - (f / p[0]) ** 2 + 2j * p[1] * f / p[0]) + p[4] + 1j * p[5]
        return np.concatenate([(model - h / abs(h[k])).real, (model - h / abs(h[k])).imag])

    zeta = half_power(f, h)
    start = [f[k], zeta, 2 * zeta, 0.0, 0.0, 0.0]
    return abs(optimize.least_squares(residual, start, x_scale=[zeta * f[k], zeta, 2 * zeta, 2 * zeta, 1, 1]).x[1])


def lscf(f, h, order, band=None):
    """Stable pole next to the largest line, by the program's own stabilisation."""
    from sdypy import EMA

    low, high = band or (f[0], f[-1])
    inside = (f >= low) & (f <= high)
    peak = f[inside][np.argmax(np.abs(h[inside]))]
    with contextlib.redirect_stdout(io.StringIO()):
        model = EMA.Model(frf=h[None, :], freq=f, lower=low, upper=high, pol_order_high=order, frf_form="receptance")
        model.get_poles("lscf", show_progress=False)
        model.select_closest_poles([peak])
    zeta = float(model.nat_xi[0])
    if zeta <= 0:
        raise ValueError("no stable pole")
    return zeta


def frf(r):
    from pyFRF import FRF

    force, response = r.values[::2], r.values[1::2]
    found = FRF(sampling_freq=round(1 / r.step), exc=force, resp=response, exc_type="f", resp_type="d", window="hann",
                fft_len=2048, nperseg=2048, noverlap=1024, frf_estimator="H1")
    return found.get_f_axis()[1:], np.squeeze(found.get_FRF(frf_form="receptance"))[1:]


def subspace(values, rate):
    """SSI of order 2, for one mode, from the response alone. Criteria that need two channels are off. (With order_in="find_min" it finds no stable pole in
    most records.)"""
    from pyoma2.algorithms import SSI
    from pyoma2.setup import SingleSetup

    f, power = signal.periodogram(values, rate, window="hann")
    setup = SingleSetup(values[:, None], fs=rate)
    limits = {"xi_max": 0.2, "mpc_lim": None, "mpd_lim": None, "CoV_max": None}
    setup.add_algorithms(SSI(name="ssi", method="cov", br=20, ordmax=10, hc=limits))
    setup.run_by_name("ssi")
    setup.mpe("ssi", sel_freq=[float(f[np.argmax(power)])], order_in=2)
    found = setup["ssi"].result.Xi
    if len(found) == 0:
        raise ValueError("no stable pole")
    return float(np.ravel(found)[0])


def decrement(r):
    """Logarithms of successive peaks to a fifth of the highest, and a straight line through them."""
    f = hann_parabola(r)
    peaks = signal.find_peaks(r.values, distance=0.7 / (f * r.step))[0]
    low = peaks[r.values[peaks] < 0.2 * r.values.max()]
    peaks = peaks[peaks < low[0]] if len(low) else peaks
    slope = -np.polyfit(r.times[peaks], np.log(r.values[peaks]), 1)[0] / f
    return slope / math.hypot(slope, 2 * math.pi)


def fitted_decay(r):
    f, zeta = hann_parabola(r), max(decrement(r), 1e-4)

    def model(t, a, b, f, s):
        return np.exp(-s * t) * sine(t, a, b, f)

    start = [*(3 * q for q in quadratures(r, f)), f, 2 * math.pi * zeta * f]
    _, _, f, s = optimize.curve_fit(model, r.times, r.values, start)[0]
    return s / math.hypot(s, 2 * math.pi * f)


def impact_peaks(r):
    """Peaks above half the highest sample, 100 samples apart at least."""
    return signal.find_peaks(r.values, height=0.5 * r.values.max(), distance=100)[0]


def impact_rate(r):
    peaks = impact_peaks(r)
    return (len(peaks) - 1) / (peaks[-1] - peaks[0]) / r.step


def impact_interval(r):
    peaks = impact_peaks(r)
    if len(peaks) != 20:
        raise ValueError(f"{len(peaks)} impacts instead of 20")
    return (peaks[10] - peaks[9]) * r.step


SCIPY, EMA, FRF, OMA = ("SciPy", "scipy"), ("sdypy-EMA", "sdypy-EMA"), ("pyFRF", "pyFRF"), ("pyOMA-2", "pyOMA_2")
FREQUENCY = [
    ([SCIPY], "largest line", largest_line),
    ([SCIPY], "periodogram, parabola", hann_parabola),
    ([SCIPY], "curve_fit", lambda r: fitted_sine(r)[2]),
]
METHODS = {
    "sine-noise": FREQUENCY,
    "sine-length": FREQUENCY,
    "sine-amplitude": [
        ([SCIPY], "flat top", lambda r: periodogram(r, "flattop")[1].max()),
        ([SCIPY], "curve_fit", lambda r: math.hypot(*fitted_sine(r)[:2])),
    ],
    "two-sines": [
        ([SCIPY], "find_peaks, parabola", lambda r: second_peak(r)[1]),
        ([SCIPY], "curve_fit", fitted_pair),
    ],
    "integration": [([SCIPY], "trapezoids, high-pass", integrated)],
    "damping": [
        ([SCIPY], "half power (peak_widths)", lambda r: half_power(r.frequencies, r.complex)),
        ([SCIPY], "least_squares", one_mode),
        ([EMA], "LSCF, order 10", lambda r: lscf(r.frequencies, r.complex, 10)),
        ([EMA], "LSCF, order 30", lambda r: lscf(r.frequencies, r.complex, 30)),
    ],
    "decay": [
        ([SCIPY], "log decrement (find_peaks)", decrement),
        ([SCIPY], "curve_fit", fitted_decay),
        ([OMA], "SSI-cov, order 2", lambda r: subspace(r.values, 1 / r.step)),
    ],
    "shaker": [
        ([FRF, SCIPY], "H1, half power", lambda r: half_power(*frf(r))),
        ([FRF, EMA], "H1, LSCF, order 30", lambda r: lscf(*frf(r), 30, (50, 150))),
        ([OMA], "SSI-cov, order 2, response alone", lambda r: subspace(r.values[1::2], 1 / r.step)),
    ],
    "impact-rate": [([SCIPY], "find_peaks", impact_rate)],
    "impact-times": [([SCIPY], "find_peaks", impact_interval)],
}


class Record:
    def __init__(self, row, values):
        self.values, self.truth, self.unit = values, row["truth"], row["unit"]
        self.start, self.step, self.known = row["start"], row["step"], row["known"]
        self.times = self.step * np.arange(len(values))

    @property
    def complex(self):
        """Lines of a frequency response function."""
        return self.values[::2] + 1j * self.values[1::2]

    @property
    def frequencies(self):
        return self.start + self.step * np.arange(len(self.values) // 2)


def measured(scene, setting, name, method, records):
    """One line: the error over all records, and the median time of some. Beside it the median of the errors, which a few poles of noise do not move."""
    errors, times, why = [], [], None
    for number, r in enumerate(records):
        begun = time.perf_counter()
        try:
            error = (method(r) - r.truth) / r.unit
            if not math.isfinite(error):
                raise ValueError("it gives no number")
            errors.append(error)
        except Exception as fault:  # what another program raises is part of the answer
            why = why or f"{type(fault).__name__}: {fault}"
        if number < TIMED:
            times.append(time.perf_counter() - begun)
    count, answers = len(records), len(errors)
    rms = math.sqrt(np.mean(np.square(errors))) if 2 * answers >= count else None
    line = {"scene": scene, "method": name, "setting": setting, "error": rms, "time_ns": 1e9 * float(np.median(times))}
    if answers < count:
        line["why"] = f"{count - answers} of {count} records refused: {why}"
    middle = float(np.median(np.abs(errors))) if rms else None
    print(f"{scene}, {setting}, {name}: rms {rms}, median {middle}; {answers} of {count}", file=sys.stderr)
    return line, middle


def shown(errors):
    """Errors by setting, a dash where fewer than half of the records have an answer."""
    return ", ".join("–" if e is None else f"{e:.2g}".replace("e-0", "e-").replace("e+0", "e") for e in errors)


def table(lines, vibro):
    """Errors and times of both, a row for each method, in Markdown."""
    print("| scene | method | rms errors | median errors | × | refused |\n|---|---|---|---|---|---|")
    for scene in vibro["scenes"]:
        name = scene["name"]
        theirs = [{**line, "median": middle} for line, middle in lines if line["scene"] == name]
        if not theirs:
            continue
        ours = [m for m in scene["methods"] if m["ours"]]
        # Times are in units of those of vibro's most accurate method on the same kind of record.
        own = ours[-1]["method"]
        base = {m["setting"]: m["time_ns"] for m in ours if m["method"] == own}
        rows = [("vibro: ", m) for m in ours] + [("", line) for line in theirs]
        for whose, method in dict.fromkeys((w, m["method"]) for w, m in rows):
            mine = [m for w, m in rows if (w, m["method"]) == (whose, method)]
            ratio = float(np.median([m["time_ns"] / base[m["setting"]] for m in mine]))
            refused = sum(int(m["why"].split()[0]) for m in mine if m.get("why"))
            medians = shown(m["median"] for m in mine) if "median" in mine[0] else ""
            print(f"| {name} | {whose}{method} | {shown(m['error'] for m in mine)} | {medians} | {ratio:.2g} | {refused or ''} |")


def main():
    folder, out, *vibro = sys.argv[1:]
    warnings.simplefilter("ignore")
    logging.disable(logging.CRITICAL)
    with open(os.path.join(folder, "records.json")) as file:
        rows = json.load(file)
    values = np.memmap(os.path.join(folder, "records.f64"), dtype="<f8", mode="r")
    kinds = {}
    for row in rows:
        kinds.setdefault((row["scene"], row["setting"]), []).append(row)
    lines = []
    for (scene, setting), rows in kinds.items():
        records = [Record(row, np.array(values[row["first"] : row["first"] + row["count"]])) for row in rows]
        for programs, what, method in METHODS.get(scene, []):
            name = " + ".join(f"{program} {version(package)}" for program, package in programs)
            lines.append(measured(scene, setting, f"{name}, {what}", method, records))
    with open(out, "w") as file:
        json.dump([line for line, _ in lines], file, indent=1)
    if vibro:
        with open(vibro[0]) as file:
            table(lines, json.load(file))


if __name__ == "__main__":
    main()
