"""Reads files."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import Literal

from ._record import Recording, read_file
from ._words import Joined


def read(
    path: str | PathLike[str],
    *,
    format: str | None = None,
    allow_missing: bool = False,
    rate: float | None = None,
    base_band: float | None = None,
    unit: str | Sequence[str] | None = None,
    axis_unit: str | None = None,
    decimal: Literal["comma", "point"] | None = None,
    complex: bool = False,
    wrapped: bool = False,
    columns: bool = False,
    span: tuple[float | None, float | None] | None = None,
    stretch: int | None = None,
    resample: float | None = None,
) -> Recording:
    """Reads a measurement file of any known format: UFF-58, WAV, TDMS, LVM, MAT, HDF5, CSV, text, workbooks.

    The format is detected from the content. What was skipped or assumed is in ``.findings``.

    Raises ``BadInput`` where the file cannot be read, is of no known format, or is not what it should be.

    Arguments:
        format: File format, instead of detecting it.
        allow_missing: Keep NaN, Inf and blank values as missing, instead of refusing them.
        rate: Sampling rate in Hz: the values are a time trace.
        base_band: Base band in Hz: the values are the lines of a spectrum from 0 to it.
        unit: Unit of the values, such as ``"mm/s"``; of one channel ``"NAME=UNIT"``.
        axis_unit: Unit of the times or frequencies whose column in a text names none, such as ``"ms"``.
        decimal: Decimal mark, where the file leaves it open.
        complex: Two columns of values are real and imaginary part.
        wrapped: Rows of several columns continue each other as one series.
        columns: Each column is a channel, however much the rows look like one series.
        span: Only this part of a time trace, ``(from, to)`` in s; ``None`` for an open end.
        stretch: Stretch between lost samples that is used, by its number from 1.
        resample: Rate in Hz at which samples of uneven times are interpolated.
    """
    options = {
        "format": format,
        "allow_missing": allow_missing,
        "rate": rate,
        "base_band": base_band,
        "unit": unit,
        "axis_unit": axis_unit,
        "decimal": decimal,
        "complex": complex,
        "wrapped": wrapped,
        "columns": columns,
        "span": Joined(":", span),
        "stretch": stretch,
        "resample": resample,
    }
    return read_file(path, options)
