"""Records: values with their axis, unit and findings."""

from __future__ import annotations

import html
from collections.abc import Iterable, Iterator, Mapping, Sequence
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
import numpy.typing as npt

from ._answer import Finding, finding
from ._errors import BadInput
from ._fields import Fields
from ._figure import Figure
from ._native import Drawing, Head
from ._native import read as _read
from ._native import write as _write
from ._progress import Bar
from ._words import words

if TYPE_CHECKING:
    import pandas
    import pyarrow  # type: ignore[import-untyped]
    import xarray

Array = npt.NDArray[Any]


class Record:
    """Values over time or frequency, in SI units.

    ``values`` is an array of float or complex, shape ``(n,)``. ``numpy.asarray(record)`` gives it, too.
    """

    values: Array
    """The values, in ``unit``."""

    def __init__(self, head: Head, values: Array) -> None:
        self._head = head
        self.values = values

    @classmethod
    def of(
        cls,
        values: npt.ArrayLike,
        *,
        rate: float | None = None,
        time: npt.ArrayLike | None = None,
        frequency: npt.ArrayLike | None = None,
        start: float = 0.0,
        unit: str | None = None,
        name: str = "",
        kind: Literal["trace", "spectrum", "frf"] | None = None,
    ) -> Record:
        """A record of an array.

        State ``rate`` in Hz (the first sample is at ``start`` in s), the instants ``time`` in s, or the
        ``frequency`` of lines in Hz. Instants within a thousandth of a step of an even axis are on it. ``unit`` is that of the values, such as ``"mm/s"``; they are kept in SI.
        ``kind`` is ``trace``, ``spectrum`` (peak values) or ``frf``; by default complex values over frequency
        are a frf, real ones a spectrum.

        Raises ``BadInput`` where the unit is not known, or values and axis differ in length.
        """
        array = numbers(values)
        if array.ndim != 1:
            raise BadInput(f"values of shape {array.shape}; expected one dimension, a record for each channel")
        if sum(stated is not None for stated in (rate, time, frequency)) > 1:
            raise BadInput("more than one of rate, time and frequency; expected one of them")
        over = time if time is not None else frequency
        at = None if over is None else numbers(over)
        if at is not None and at.shape != array.shape:
            raise BadInput(f"{len(array)} values over an axis of {at.size}; expected equal numbers")
        if at is not None and (np.iscomplexobj(at) or not np.isfinite(at).all()):
            raise BadInput("an axis with values that are not finite; expected real numbers")
        if not np.isfinite(start) or (start and rate is None):
            raise BadInput(f"start is {start} s; expected a number beside rate=")
        if kind not in (None, "trace", "spectrum", "frf"):
            raise BadInput(f"kind is {kind!r}; expected 'trace', 'spectrum' or 'frf'")
        if kind is not None and (frequency is None) != (kind == "trace"):
            axis = "rate= or time=" if kind == "trace" else "frequency="
            raise BadInput(f"a {kind} over another axis; expected {axis}")
        made: str | None = kind
        if made is None:
            made = "trace" if frequency is None else "frf" if np.iscomplexobj(array) else "spectrum"
        if made == "spectrum" and np.iscomplexobj(array):
            made = "complex spectrum"
        if made == "frf":
            array = array.astype(complex)
        if made == "trace" and np.iscomplexobj(array):
            raise BadInput("complex values over time; expected real ones, or frequency=")
        if rate is not None:
            rate = above_zero("rate", rate)
        even = None if rate is None else (start, 1.0 / rate)
        uneven = None
        if at is not None:
            step = abs(float(at[-1] - at[0])) / max(len(at) - 1, 1) if len(at) else 0.0
            digits = np.finfo(np.asarray(over).dtype).eps if np.asarray(over).dtype.kind == "f" else 0.0
            uneven = (at.tolist(), 1e-3 * step + float(digits) * float(np.abs(at).max(initial=0.0)))
        head, factor = Head.made(made, len(array), name, unit or "", even, uneven)
        if factor != 1.0:
            array *= factor
        return cls(head, array)

    @property
    def kind(self) -> str:
        """``trace``, ``spectrum`` or ``frf``."""
        return self._head.kind

    @property
    def name(self) -> str:
        """Name of the channel."""
        return self._head.name

    @property
    def quantity(self) -> str:
        """Quantity, such as ``velocity``."""
        return self._head.quantity

    @property
    def unit(self) -> str:
        """SI unit of the values."""
        return self._head.unit

    @property
    def rate(self) -> float | None:
        """Sampling rate in Hz; ``None`` for uneven samples and over frequency."""
        step = self._head.step
        return 1.0 / step if step and self._head.x_unit == "s" else None

    @property
    def axis(self) -> Array:
        """Values of the axis in ``axis_unit``, shape ``(n,)``."""
        return self._head.axis()

    @property
    def axis_unit(self) -> str:
        """``s``, ``Hz``, or empty where the file does not say."""
        return self._head.x_unit

    @property
    def time(self) -> Array:
        """Instants in s. Raises ``AttributeError`` for a record that is not over time."""
        return self._over("s", "time")

    @property
    def frequency(self) -> Array:
        """Frequencies in Hz. Raises ``AttributeError`` for a record that is not over frequency."""
        return self._over("Hz", "frequency")

    def _over(self, unit: str, name: str) -> Array:
        if self.axis_unit != unit:
            raise AttributeError(f"a {self.kind} over [{self.axis_unit}] has no {name}; its axis is .axis")
        return self.axis

    @property
    def meta(self) -> Fields:
        """``notes``, lines of the file that were kept, and ``history``, the steps from file to record."""
        meta: Fields = self._head.meta()
        return meta

    @property
    def findings(self) -> list[Finding]:
        """What must be known before the values are trusted."""
        return [finding(told, self.name) for told in self._head.findings()]

    def figure(self) -> Figure:
        """The values over their axis; of complex values the magnitude."""
        values = np.abs(self.values) if self._head.complex else self.values
        drawing = Drawing.of_record(self._head, np.ascontiguousarray(values, float))
        return Figure(self.name or self.kind, drawing)

    def plot(self, ax: Any = None) -> Any:
        """Draws all values with matplotlib on ``ax``, or on a new figure. Returns the axes."""
        if ax is None:
            import matplotlib.pyplot as plt

            _, ax = plt.subplots(layout="constrained")
        ax.plot(self.axis, np.abs(self.values) if self._head.complex else self.values, label=self.name or None)
        across = {"s": "Time [s]", "Hz": "Frequency [Hz]"}.get(self.axis_unit, "Number")
        ax.set(xlabel=across, ylabel=f"{self.quantity} [{self.unit}]")
        return ax

    def to_pandas(self) -> pandas.Series[Any]:
        """A series over time or frequency; ``attrs`` has the unit."""
        import pandas

        index = pandas.Index(self.axis, name={"s": "time [s]", "Hz": "frequency [Hz]"}.get(self.axis_unit))
        series = pandas.Series(self.values, index=index, name=self.name or None, copy=False)
        series.attrs.update(unit=self.unit, quantity=self.quantity)
        return series

    @classmethod
    def from_pandas(cls, series: pandas.Series[Any], *, unit: str | None = None) -> Record:
        """The record of a series whose index is named ``time [s]`` or ``frequency [Hz]``, as ``to_pandas`` makes it.

        ``unit`` is that of its values: ``attrs`` are not read, since pandas keeps them when values are changed.

        Raises ``BadInput`` where the index has another name.
        """
        over = {"time [s]": "time", "frequency [Hz]": "frequency"}.get(str(series.index.name))
        if over is None:
            raise BadInput(f"an index named {series.index.name!r}; expected 'time [s]' or 'frequency [Hz]'")
        name = "" if series.name is None else str(series.name)
        at: dict[str, Any] = {over: series.index.to_numpy()}
        return cls.of(series.to_numpy(), unit=unit, name=name, **at)

    def to_xarray(self) -> xarray.DataArray:
        """An array with its axis as coordinate; ``attrs`` have the units."""
        import xarray

        over = {"s": "time", "Hz": "frequency"}.get(self.axis_unit, "number")
        axis = (over, self.axis, {"units": self.axis_unit})
        attrs = {"units": self.unit, "quantity": self.quantity}
        return xarray.DataArray(self.values, {over: axis}, [over], self.name or None, attrs)

    def to_arrow(self) -> pyarrow.Table:
        """An Arrow table with the axis and the values; needs pyarrow. Units are in the metadata of the fields."""
        return _arrow([self])

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """The table by the PyCapsule interface of Arrow: ``polars.DataFrame(record)`` takes a record as it is."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def to_sep005(self) -> dict[str, Any]:
        """A dictionary by the proposal SEP-005 for time series.

        Raises ``BadInput`` for a record that is not over time.
        """
        if self.kind != "trace" or self.axis_unit != "s":
            raise BadInput(f"a {self.kind} over [{self.axis_unit}]; expected a trace over time")
        made = {"data": self.values, "name": self.name, "unit_str": self.unit}
        return made | ({"time": self.time} if self.rate is None else {"fs": self.rate})

    @classmethod
    def from_sep005(cls, series: Mapping[str, Any]) -> Record:
        """The record of a dictionary by the proposal SEP-005.

        Raises ``BadInput`` where the unit is not known, or there is neither ``fs`` nor ``time``.
        """
        rate, time = series.get("fs"), series.get("time")
        if "data" not in series or (rate is None and time is None):
            raise BadInput("a series needs 'data', and 'fs' or 'time'")
        given: dict[str, Any] = {"rate": rate} if rate is not None else {"time": time}
        return cls.of(series["data"], unit=series.get("unit_str"), name=str(series.get("name", "")), **given)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        return np.array(self.values, dtype, copy=copy) if copy else np.asarray(self.values, dtype)

    def __len__(self) -> int:
        return len(self.values)

    def __repr__(self) -> str:
        over = f"{self.rate:g} Hz" if self.rate else f"over [{self.axis_unit}]"
        return f"<{self.kind} {self.name!r}: {len(self)} values in {self.unit or '?'}, {over}>"

    def _repr_html_(self) -> str:
        told = "".join(f"<li>{html.escape(str(finding))}</li>" for finding in self.findings)
        return f"{html.escape(repr(self))}{self.figure()._repr_html_()}<ul>{told}</ul>"


class Recording(Sequence[Record]):
    """The records of a file: ``recording["force"]``, or by number from 0."""

    def __init__(self, path: str, format: str, findings: Iterable[Finding], records: Iterable[Record]) -> None:
        self.path = path
        """The file."""
        self.format = format
        """Its format."""
        self._findings = list(findings)
        self.records = list(records)
        """Its records."""

    @property
    def findings(self) -> list[Finding]:
        """Findings on the file, then those on its records."""
        return self._findings + [finding for record in self.records for finding in record.findings]

    @property
    def names(self) -> list[str]:
        """Names of the records."""
        return [record.name for record in self.records]

    @overload
    def __getitem__(self, key: int | str) -> Record: ...
    @overload
    def __getitem__(self, key: slice) -> list[Record]: ...
    def __getitem__(self, key: int | str | slice) -> Record | list[Record]:
        if not isinstance(key, str):
            return self.records[key]
        named = [record for record in self.records if record.name == key]
        if len(named) != 1:
            what = "no record" if not named else f"{len(named)} records"
            raise KeyError(f"{what} of the name {key!r}; there are {', '.join(map(repr, self.names))}")
        return named[0]

    def __len__(self) -> int:
        return len(self.records)

    def __iter__(self) -> Iterator[Record]:
        return iter(self.records)

    def to_pandas(self) -> pandas.DataFrame:
        """A data frame with a column for each record.

        Raises ``BadInput`` where records have different axes: convert them one by one.
        """
        import pandas

        _one_axis(self.records)
        return pandas.concat([record.to_pandas() for record in self.records], axis=1)

    def to_arrow(self) -> pyarrow.Table:
        """An Arrow table with the axis and a column for each record; needs pyarrow.

        Raises ``BadInput`` where records have different axes: convert them one by one.
        """
        return _arrow(self.records)

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """The table by the PyCapsule interface of Arrow: ``polars.DataFrame(recording)`` takes it as it is."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def __repr__(self) -> str:
        lines = [f"<{self.format} {self.path}: {len(self)} records>", *(f"  {record!r}" for record in self)]
        return "\n".join(lines + [f"  {finding}" for finding in self.findings])

    def _repr_html_(self) -> str:
        told = "".join(f"<li>{html.escape(str(finding))}</li>" for finding in self._findings)
        head = f"{html.escape(self.path)}, {self.format}<ul>{told}</ul>"
        return head + "".join(record._repr_html_() for record in self)


def _one_axis(records: Sequence[Record]) -> Array:
    """The axis that all records have."""
    first, *others = records
    axis = first.axis
    if any(r.axis_unit != first.axis_unit or not np.array_equal(r.axis, axis) for r in others):
        raise BadInput("records over different axes; expected one axis: convert each record by itself")
    return axis


def _arrow(records: Sequence[Record]) -> pyarrow.Table:
    """A table with the axis of the records and their values; the parts of complex values are two columns."""
    import pyarrow

    over = {"s": "time [s]", "Hz": "frequency [Hz]"}.get(records[0].axis_unit, "number")
    columns: list[tuple[str, Array, str]] = [(over, _one_axis(records), records[0].axis_unit)]
    for record in records:
        name = record.name or record.quantity
        if np.iscomplexobj(record.values):
            columns.append((f"{name}, real", record.values.real, record.unit))
            columns.append((f"{name}, imaginary", record.values.imag, record.unit))
        else:
            columns.append((name, record.values, record.unit))
    fields = [pyarrow.field(name, pyarrow.float64(), metadata={"unit": unit}) for name, _, unit in columns]
    return pyarrow.Table.from_arrays([pyarrow.array(c) for _, c, _ in columns], schema=pyarrow.schema(fields))


def read_file(path: str | PathLike[str], options: Mapping[str, Any]) -> Recording:
    """Reads a file with options of the command line."""
    bar = Bar()
    try:
        format, findings, records = _read(fspath(path), words(options), bar)
    finally:
        bar.clear()
    found = [finding(told) for told in findings]
    return Recording(fspath(path), format, found, (Record(head, values) for head, values in records))


def write(
    path: str | PathLike[str],
    records: Record | Iterable[Record],
    *,
    single: bool = False,
    binary: bool = False,
    replace: bool = False,
) -> None:
    """Writes records into a file, in the format of its ending: .uff, .unv, .58, .ufb, .csv, .tsv, .wav, .npy.

    ``single`` stores numbers with 32 bits, where the format has them; ``binary`` writes UFF-58b. A file that
    this program did not write is replaced only with ``replace``.

    Raises ``BadInput`` for another ending, for records that the format cannot hold, or a file that is there.
    """
    all_records = [records] if isinstance(records, Record) else list(records)
    other = next((record for record in all_records if not isinstance(record, Record)), None)
    if other is not None:
        raise BadInput(f"{type(other).__name__}; expected records: make one by Record.of(array, rate=…, unit=…)")
    _write(fspath(path), [(r._head, _plain(r)) for r in all_records], single, binary, replace)


def write_uff(
    path: str | PathLike[str], records: Record | Iterable[Record], *, binary: bool = True, replace: bool = False
) -> None:
    """Writes records as UFF-58, or UFF-58b with ``binary``, into a file that ends in .uff, .unv, .58 or .ufb.

    Raises ``BadInput`` as ``write``.
    """
    write(path, records, binary=binary, replace=replace)


def numbers(values: Any) -> Array:
    """A new array of float or complex.

    Raises ``BadInput`` where the values are no numbers.
    """
    try:
        array = np.asarray(values)
        if array.dtype.kind not in "biufc":
            raise TypeError
        # Not all versions of NumPy state the types of its masked arrays.
        masked: Any = np.ma
        if masked.is_masked(values):
            return np.asarray(masked.filled(values.astype(array.dtype if array.dtype.kind == "c" else float), np.nan))
        return np.array(array, complex if np.iscomplexobj(array) else float)
    except (TypeError, ValueError):
        raise BadInput(f"{type(values).__name__}; expected numbers in one dimension") from None


def above_zero(name: str, value: Any) -> float:
    """A number above 0.

    Raises ``BadInput`` where it is none.
    """
    try:
        number = float(value) if not isinstance(value, str) else float("nan")
    except (TypeError, ValueError):
        number = float("nan")
    if not (np.isfinite(number) and number > 0):
        raise BadInput(f"{name} is {value!r}; expected a number above 0")
    return number


def _plain(record: Record) -> Array:
    """The values as an array that Rust takes."""
    if np.iscomplexobj(record.values) and not record._head.complex:
        raise BadInput(f"complex values in the {record.kind} {record.name!r}; expected real ones")
    return np.ascontiguousarray(record.values, complex if record._head.complex else float)
