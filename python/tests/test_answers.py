"""Answers of measurements and models, and how long work is stopped."""

import _thread
import math
import multiprocessing
import re
import signal
import threading
import time

import numpy as np
import pytest

import vibroimpact as vi

RATE = 2000.0


def ringing(frequency=50.0, zeta=0.02, seconds=2.0, noise=1e-3):
    """A free decay whose frequency and damping ratio are known."""
    t = np.arange(int(seconds * RATE)) / RATE
    omega = 2 * math.pi * frequency
    made = np.exp(-zeta * omega * t) * np.cos(omega * math.sqrt(1 - zeta**2) * t)
    return made + noise * np.random.default_rng(7).standard_normal(t.size)


def test_a_decay_of_an_array_holds_its_truth():
    answer = vi.decay(ringing(), rate=RATE, unit="mm/s")
    mode = answer.modes[0]
    assert isinstance(mode.frequency, vi.Estimate) and mode.frequency.unit == "Hz"
    # Four standard uncertainties: 6 in 100 000 records are beyond.
    assert abs(mode.frequency.value - 50.0) < 4 * mode.frequency.std
    assert abs(float(mode.zeta) - 0.02) < 4 * mode.zeta.std
    low, high = mode.frequency.interval()
    assert low < mode.frequency.value < high
    assert "Modes" in str(answer) and answer["modes"] is answer.modes


def test_array_record_and_file_give_one_answer(tmp_path):
    values = ringing()
    record = vi.Record.of(values, rate=RATE, unit="mm/s", name="v")
    vi.write(tmp_path / "v.uff", record, binary=True)
    answers = [
        vi.decay(values, rate=RATE, unit="mm/s"),
        vi.decay(record),
        vi.decay([record]),
        vi.decay(tmp_path / "v.uff"),
        vi.decay(vi.read(tmp_path / "v.uff")),
    ]
    frequencies = {answer.modes[0].frequency.value for answer in answers}
    # A step of 0.5 ms is printed exactly, so all digits agree.
    assert len(frequencies) == 1


def test_a_frequency_response_and_its_modes():
    rng = np.random.default_rng(3)
    n, omega, zeta = 40_000, 2 * math.pi * 100.0, 0.02
    force = rng.standard_normal(n)
    # One mode by its exact response to a force held over a step.
    a = np.exp((-zeta + 1j * math.sqrt(1 - zeta**2)) * omega / RATE)
    x, state = np.empty(n), 0j
    for k, f in enumerate(force):
        state = a * state + f
        x[k] = state.imag
    both = [vi.Record.of(force, rate=RATE, unit="N", name="force"), vi.Record.of(x, rate=RATE, unit="um", name="x")]
    found = vi.modal(both, reference="force")
    mode = found.modes[0]
    assert abs(mode.frequency.value - 100.0) < 4 * mode.frequency.std
    assert len(vi.frf(both, "force", channel="x").frequency) > 100


def test_a_refusal_has_its_reason():
    with pytest.raises(vi.Refused) as refused:
        vi.decay(np.zeros(500) + 1e-12, rate=RATE)
    assert len(str(refused.value)) > 10
    with pytest.raises(vi.BadInput, match="rate"):
        vi.decay(ringing())
    with pytest.raises(vi.BadInput, match="its own"):
        vi.decay(vi.Record.of(ringing(), rate=RATE), rate=RATE)
    with pytest.raises(vi.BadInput, match="in memory"):
        vi.decay(vi.Record.of(ringing(), rate=RATE), format="uff")
    with pytest.raises(TypeError):
        vi.decay(ringing(), rate=RATE, colour="red")
    gap = ringing()
    gap[5] = math.nan
    with pytest.raises(vi.BadInput, match="allow_missing="):
        vi.decay(gap, rate=RATE)
    with pytest.raises(vi.BadInput, match="no values"):
        vi.decay([], rate=RATE)


def test_messages_speak_of_functions_and_arguments(tmp_path):
    for asked, said in [
        (lambda: vi.decay(ringing(), rate=RATE, modes=2.5), "modes is 2.5"),
        (lambda: vi.decay(ringing(), rate=RATE, band=12), "band"),
        (lambda: vi.spectrum(ringing(), rate=RATE, method="welsh"), "method='welch'"),
        (lambda: vi.Rig().simulate(force=0.5, frequency=11, model="kv"), "model"),
        (lambda: vi.decay(ringing(), rate="1024"), "rate is '1024'"),
        (lambda: vi.decay([[1.0], [1.0, 2.0]], rate=RATE), "different lengths"),
        (lambda: vi.decay(5), "expected a file"),
        (lambda: vi.write(tmp_path / "x.csv", ringing()), "Record.of"),
        (lambda: vi.decay(tmp_path), r"Campaign\("),
    ]:
        with pytest.raises(vi.BadInput, match=said) as bad:
            asked()
        assert "--" not in str(bad.value) and "vibro " not in str(bad.value), str(bad.value)


def test_an_answer_is_pickled():
    import pickle

    answer = vi.Rig().orbits(frequency=11.2, force=0.5)
    again = pickle.loads(pickle.dumps(answer))
    assert str(again) == str(answer) and again.figure().svg() == answer.figure().svg()
    assert again.orbits[0].impulse == answer.orbits[0].impulse
    with pytest.raises(KeyError, match="there are"):
        answer["freq"]


def test_estimates_are_compared_by_value():
    answer = vi.decay(ringing(), rate=RATE)
    assert answer.modes[0].frequency > 49 and answer.modes[0].frequency < 51
    assert max(answer.modes, key=lambda mode: mode.amplitude) is answer.modes[0]


def test_several_files_and_series_are_taken(tmp_path):
    record = vi.Record.of(ringing(), rate=RATE, unit="mm/s", name="v")
    assert vi.decay(record.to_pandas()).modes[0].frequency.value == pytest.approx(50.0, abs=0.05)
    with pytest.raises(vi.BadInput, match="index of times"):
        vi.decay(record.to_pandas(), rate=4000)
    with pytest.raises(vi.BadInput, match="arrays beside files"):
        vi.spectrum(ringing(), tmp_path / "a.uff", rate=RATE)
    paths = [tmp_path / "a.uff", tmp_path / "b.uff"]
    for path in paths:
        vi.write_uff(path, record)
    assert len(vi.spectrum(paths).figures) >= 1


def test_a_doubt_of_the_file_goes_with_its_records(tmp_path):
    path = tmp_path / "row.csv"
    rows = [f"{k / RATE:.4f};{1e3 * v:.6f}" for k, v in enumerate(ringing())]
    path.write_text("\n".join(["t [s];v [mm/s]", "ms;mm/s", *rows]) + "\n")
    of_file, of_records = vi.decay(path), vi.decay(vi.read(path))
    assert {f.code for f in of_file.findings} == {f.code for f in of_records.findings}
    for mode, same in zip(of_file.modes, of_records.modes, strict=True):
        assert (mode.frequency.value, mode.frequency.std) == (same.frequency.value, same.frequency.std)
    assert any(f.severity == "doubt" for f in of_records.findings)


def test_masked_values_are_missing():
    with pytest.raises(vi.BadInput, match="allow_missing="):
        vi.decay(np.ma.masked_array(ringing(), ringing() > 0.5), rate=RATE)


def test_a_rig_answers_with_orbits_and_figures():
    rig = vi.Rig(gap=0.5e-3)
    answer = rig.orbits(frequency=11.2, force=0.5)
    assert len(answer.orbits) >= 1 and "orbit_1" in answer.figures
    assert "<svg" in answer._repr_html_()
    other = vi.Rig(gap=1e-3).orbits(frequency=11.2, force=0.5)
    assert [o.approach_velocity for o in other.orbits] != [o.approach_velocity for o in answer.orbits]
    with pytest.raises(vi.BadInput, match="gap"):
        vi.Rig(gapp=0.5e-3).orbits(frequency=11.2, force=0.5)
    import matplotlib

    matplotlib.use("agg")
    assert answer.plot() is not None


def test_tables_are_frames():
    frame = vi.decay(ringing(), rate=RATE, unit="mm/s").tables[0].to_pandas()
    assert frame["frequency [Hz]"][0] == pytest.approx(50.0, abs=0.1)
    assert frame["frequency [Hz] std"][0] > 0


def test_long_work_stops_at_ctrl_c():
    rig = vi.Rig()
    pressed = []

    def press():
        time.sleep(0.5)
        pressed.append(time.monotonic())
        _thread.interrupt_main()

    # Of a program that a shell started in the background, Ctrl+C is ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Thread(target=press).start()
    with pytest.raises(KeyboardInterrupt):
        rig.map(x=("frequency", 3, 14, 400), y=("gap", 1e-4, 1e-3, 400), force=0.5)
    assert time.monotonic() - pressed[0] < 0.2
    signal.signal(signal.SIGINT, before)


def test_other_threads_run_meanwhile():
    ticks = []
    done = threading.Event()

    def tick():
        while not done.wait(0.005):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    began = time.monotonic()
    vi.Rig().map(x=("frequency", 3, 14, 60), y=("gap", 1e-4, 1e-3, 60), force=0.5)
    took = time.monotonic() - began
    done.set()
    thread.join()
    assert took < 0.05 or len(ticks) > 2


def mode_of(seed):
    """The frequency of one decay, in a process of its own."""
    return vi.decay(ringing(40.0 + seed), rate=RATE).modes[0].frequency.value


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="no fork here")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_forked_process_measures_too():
    assert mode_of(0) == pytest.approx(40.0, abs=0.05)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        found = pool.map_async(mode_of, range(4)).get(timeout=30)
    assert found == pytest.approx([40.0, 41.0, 42.0, 43.0], abs=0.05)


def names_in(answer):
    """All names in an answer, at any depth."""
    if isinstance(answer, dict):
        return set(answer) | {name for value in answer.values() for name in names_in(value)}
    if isinstance(answer, list):
        return {name for value in answer for name in names_in(value)}
    return set()


def test_answers_hold_what_their_help_says(tmp_path):
    for name in ("bench", "drop_test"):
        vi.demo(name, tmp_path / name)
    bench, drops = tmp_path / "bench", tmp_path / "drop_test"
    answers = {
        vi.spectrum: vi.spectrum(bench / "BENCH.CSV", channel="velocity", tones=1),
        vi.impacts: vi.impacts(drops / "CONTACT.DAT", base_band=50, unit="V", excitation=11.2),
        vi.restitution: vi.restitution(drops / "BOUNCE.CSV", height=0.57),
        vi.pulse: vi.pulse(bench / "PULSE.CSV", mass=0.125, low_pass="none"),
        vi.decay: vi.decay(bench / "DECAY.CSV"),
        vi.modal: vi.modal(bench / "BENCH.CSV", reference="force", channel="velocity", segment=1024, mass=0.125),
    }
    for function, answer in answers.items():
        told = re.search(r"The answer: (.*?) A number", " ".join(function.__doc__.split()))
        names = set(re.findall(r"``([a-z_]+)``", told[1]))
        assert len(names) > 3 and names <= names_in(answer), function.__name__
