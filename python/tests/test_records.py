"""Records: from arrays and files, to files, frames and other libraries."""

import pickle
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import vibroimpact as vi

RATE = 1000.0


@pytest.fixture
def bench(tmp_path):
    """A text of two channels, written by hand."""
    t = np.arange(200) / RATE
    lines = ["t [s];force [N];v [mm/s]", *(f"{a:.3f};{np.sin(60 * a):.6f};{10 * np.cos(60 * a):.6f}" for a in t)]
    path = tmp_path / "bench.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_a_file_is_records_in_si_units(bench):
    recording = vi.read(bench)
    assert (recording.format, recording.names) == ("csv", ["force", "v"])
    v = recording["v"]
    assert (v.unit, v.quantity, v.kind, len(v)) == ("m/s", "velocity", "trace", 200)
    assert v.rate == pytest.approx(RATE, rel=1e-12)
    np.testing.assert_allclose(v.values, 10e-3 * np.cos(60 * v.time), atol=1e-9)
    assert recording[1] is v and recording[:1] == [recording[0]]
    with pytest.raises(KeyError, match="'force', 'v'"):
        recording["x"]
    with pytest.raises(AttributeError, match="no frequency"):
        v.frequency  # noqa: B018


def test_values_are_not_copied_on_reading(bench):
    values = vi.read(bench)["v"].values
    # The memory is Rust's: the array does not own it, and its base is what frees it.
    assert not values.flags.owndata and values.flags.writeable


def test_only_a_part_is_read(bench):
    part = vi.read(bench, span=(0.05, 0.1))["force"]
    assert (len(part), part.time[0]) == (50, pytest.approx(0.05))
    assert len(vi.read(bench, span=(0.15, None))["force"]) == 50


def test_what_is_no_file_is_bad_input(tmp_path):
    with pytest.raises(vi.BadInput, match="does not exist|cannot open"):
        vi.read(tmp_path / "none.csv")
    (tmp_path / "x.csv").write_bytes(b"\x00\x01\x02" * 100)
    with pytest.raises(ValueError, match="not a format"):
        vi.read(tmp_path / "x.csv")


@pytest.mark.parametrize("values", [np.arange(6.0)[::2], np.arange(3, dtype=np.float32), [0, 1, 2], range(3)])
def test_anything_that_is_numbers_is_a_record(values):
    made = vi.Record.of(values, rate=10.0, unit="mm")
    np.testing.assert_allclose(made.values, 1e-3 * np.asarray(values, float))
    assert (made.unit, made.rate) == ("m", 10.0)


def test_impossible_records_are_bad_input():
    with pytest.raises(vi.BadInput, match="one of them"):
        vi.Record.of([1.0, 2.0], rate=1.0, time=[0.0, 1.0])
    with pytest.raises(vi.BadInput, match="equal numbers"):
        vi.Record.of([1.0, 2.0], time=[0.0, 1.0, 2.0])
    with pytest.raises(vi.BadInput, match="unit"):
        vi.Record.of([1.0, 2.0], rate=1.0, unit="furlong")
    with pytest.raises(vi.BadInput, match="above 0"):
        vi.Record.of([1.0, 2.0], rate=0.0)
    for wrong in ({"rate": 1.0, "kind": "spectrum"}, {"frequency": [1.0, 2.0], "kind": "trace"}, {"kind": "x"}):
        with pytest.raises(vi.BadInput, match="kind is|expected"):
            vi.Record.of([1.0, 2.0], **wrong)
    with pytest.raises(vi.BadInput, match="finite"):
        vi.Record.of([1.0, 2.0], time=[0.0, np.nan])
    with pytest.raises(vi.BadInput, match="start"):
        vi.Record.of([1.0, 2.0], rate=1.0, start=np.nan)
    with pytest.raises(vi.BadInput, match="shape"):
        vi.Record.of(np.zeros((2, 2)), rate=1.0)


@pytest.mark.parametrize(
    "time",
    [np.arange(4000, dtype=np.float32) / 2000, np.cumsum(np.full(4000, 1 / 2000)), np.round(np.arange(4000) / 2048, 7)],
)
def test_times_that_are_nearly_even_are_even(time):
    assert vi.Record.of(np.zeros(4000), time=time).rate == pytest.approx(4000 / (time[-1] - time[0]), rel=1e-3)


def test_a_unit_that_is_stated_again_is_not_applied_twice():
    made = vi.Record.of(np.sin(np.arange(2000) * 0.3), rate=1000.0, unit="mm")
    first, again = (np.nanmax(vi.spectrum(made, unit=unit).value) for unit in (None, "mm"))
    assert first == pytest.approx(again, rel=1e-12)


numbers = st.lists(st.floats(-1e6, 1e6), min_size=2, max_size=60)


@settings(max_examples=50, deadline=None)
@given(numbers, st.floats(0.1, 1e6), st.sampled_from(["m", "m/s", "N", "mm", "g"]))
def test_uff_holds_what_was_written(values, rate, unit):
    import tempfile
    from pathlib import Path

    made = vi.Record.of(values, rate=rate, unit=unit, name="laser")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "made.uff"
        vi.write_uff(path, made)
        (back,) = vi.read(path)
    np.testing.assert_array_equal(back.values, made.values)
    assert (back.unit, back.name) == (made.unit, "laser")
    # The step is printed with six digits of its mantissa at least.
    assert back.rate == pytest.approx(rate, rel=1e-5)


def test_a_file_of_somebody_else_is_not_replaced(tmp_path):
    path = tmp_path / "mine.uff"
    path.write_text("mine")
    made = vi.Record.of([1.0, 2.0], rate=1.0)
    with pytest.raises(vi.BadInput):
        vi.write_uff(path, made)
    assert path.read_text() == "mine"
    vi.write_uff(path, made, replace=True)
    assert len(vi.read(path)) == 1


def test_frames_and_arrays_have_axis_and_unit(bench):
    v = vi.read(bench)["v"]
    frame = vi.read(bench).to_pandas()
    assert list(frame.columns) == ["force", "v"] and frame.index.name == "time [s]"
    assert v.to_pandas().attrs["unit"] == "m/s"
    array = v.to_xarray()
    assert array.dims == ("time",) and array.attrs["units"] == "m/s"
    np.testing.assert_array_equal(np.asarray(v), v.values)


def test_sep_005_goes_out_and_in(bench):
    v = vi.read(bench)["v"]
    series = v.to_sep005()
    assert series.keys() == {"data", "name", "unit_str", "fs"}
    back = vi.Record.from_sep005(series)
    np.testing.assert_array_equal(back.values, v.values)
    assert (back.unit, back.name, back.rate) == (v.unit, v.name, v.rate)
    with pytest.raises(vi.BadInput, match="fs"):
        vi.Record.from_sep005({"data": [1.0]})


def test_a_notebook_shows_a_record(bench):
    v = vi.read(bench)["v"]
    page = v._repr_html_()
    assert "<svg" in page and "m/s" in page
    import matplotlib

    matplotlib.use("agg")
    axes = v.plot()
    assert axes.get_ylabel() == "velocity [m/s]"


def test_a_record_comes_back_from_pickle_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "odd.csv"
    path.write_text("t [ms];v [mm/s]\n" + "".join(f"{k};{k * k}\n" for k in range(40)))
    for record in [*vi.read(path), vi.Record.of(np.arange(9) * 1j, frequency=np.arange(9.0), unit="m/N", name="H")]:
        again = pickle.loads(pickle.dumps(record))
        assert np.array_equal(again.values, record.values) and np.array_equal(again.axis, record.axis)
        assert (repr(again), again.meta, again.findings) == (repr(record), record.meta, record.findings)
    recording = vi.read(path)
    again = pickle.loads(pickle.dumps(recording))
    assert (repr(again), again.findings) == (repr(recording), recording.findings)
    with pytest.raises(ValueError, match="."):
        vi._native.Head.kept(b"no head")


def test_arrow_has_axis_values_and_units() -> None:
    pyarrow = pytest.importorskip("pyarrow")
    v = vi.Record.of([0.0, 1.0, 4.0], rate=1000, unit="mm/s", name="v")
    table = pyarrow.table(v)
    assert table.column_names == ["time [s]", "v"]
    assert table["v"].to_pylist() == [0.0, 1e-3, 4e-3]
    assert table.schema.field("v").metadata == {b"unit": b"m/s"}
    h = vi.Record.of([1 + 2j], frequency=[5.0], unit="m/N", name="H")
    assert pyarrow.table(h).to_pylist() == [{"frequency [Hz]": 5.0, "H, real": 1.0, "H, imaginary": 2.0}]
    two = vi.Recording("x", "memory", [], [v, vi.Record.of([1.0, 2.0, 3.0], rate=1000, name="w")])
    assert pyarrow.table(two).column_names == ["time [s]", "v", "w"]
    with pytest.raises(vi.BadInput, match="different axes"):
        vi.Recording("x", "memory", [], [v, h]).to_arrow()
