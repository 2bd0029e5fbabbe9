"""Asks the library: records and options become a question, its answer comes back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from ._answer import Answer
from ._errors import BadInput
from ._native import Head
from ._native import ask as _ask
from ._progress import Bar
from ._record import Array, Record, Recording, _plain
from ._words import words

Source: TypeAlias = "str | PathLike[str] | Record | Recording | npt.ArrayLike"
"""A file, a record, records of one file, or an array with its ``rate`` and ``unit``."""

OF_FILES = ("format", "base_band", "axis_unit", "decimal", "complex", "wrapped", "columns")
"""Options that say how a file is read."""

Made: TypeAlias = "list[tuple[str, list[tuple[Head, Array]]]]"


def ask(command: Sequence[str], sources: Sequence[Any], options: Mapping[str, Any]) -> Answer:
    """The answer of a command on files and records, with its options."""
    given = dict(options)
    made: Made = []
    flat = [part for source in sources for part in (source if _are_files(source) else [source])]
    places = [_place(source, given, made) for source in flat]
    if made:
        stated = [name for name in OF_FILES if given.get(name)]
        if stated:
            raise BadInput(f"{stated[0]}= says how a file is read, and this record is in memory")
        if any(_is_numbers(source) for source in flat):
            if not all(_is_numbers(source) for source in flat):
                raise BadInput("arrays beside files or records; expected records: Record.of(array, rate=…, unit=…)")
            given.pop("rate", None)
            given.pop("unit", None)
    typed = [*command, *words(given)] + (["--", *places] if places else [])
    bar = Bar()
    try:
        answer: Answer = _ask(typed, made, bar)
    finally:
        bar.clear()
    return answer


def _are_files(source: Any) -> bool:
    """Whether a source is a list of files, each a source of its own."""
    is_list = isinstance(source, (list, tuple)) and len(source) > 0
    return is_list and all(isinstance(part, (str, PathLike)) for part in source)


def _is_numbers(source: Any) -> bool:
    if isinstance(source, (list, tuple)) and any(isinstance(part, Record) for part in source):
        return False
    return not isinstance(source, (str, PathLike, Record, Recording))


def _place(source: Any, options: Mapping[str, Any], made: Made) -> str:
    """The word that stands for a source; records in memory are added to ``made``."""
    if isinstance(source, (str, PathLike)):
        return fspath(source)
    if isinstance(source, Record):
        records: Sequence[Record] = [source]
    elif isinstance(source, Recording):
        records = source.records
    elif isinstance(source, (list, tuple)) and source and all(isinstance(part, Record) for part in source):
        records = source
    else:
        records = _of_array(source, options)
    if options.get("rate") is not None and not _is_numbers(source):
        raise BadInput("rate= is for arrays and files; this record has its own")
    name = records[0].name if len(records) == 1 and records[0].name else "record"
    plain = "".join(c if c.isalnum() or c in " -_" else "_" for c in name).strip() or "record"
    taken = {place for place, _ in made}
    place = next(p for k in range(len(made) + 1) if (p := plain if k == 0 else f"{plain} {k + 1}") not in taken)
    made.append((place, [(record._head, _plain(record)) for record in records]))
    return place


def _of_array(source: Any, options: Mapping[str, Any]) -> list[Record]:
    """The records of an array: one dimension, or a row for each channel."""
    rate, unit = options.get("rate"), options.get("unit") or ""
    if not isinstance(unit, str):
        raise BadInput("several units for an array; expected one: a record for each, Record.of(array, rate=…, unit=…)")
    over_time = str(getattr(getattr(source, "index", None), "name", "")) in ("time [s]", "frequency [Hz]")
    if over_time and rate is not None:
        raise BadInput("rate= beside an index of times; expected one of them")
    if over_time:
        columns = [source[name] for name in source.columns] if hasattr(source, "columns") else [source]
        return [Record.from_pandas(column, unit=unit) for column in columns]
    try:
        array = source if isinstance(source, np.ndarray) else np.asarray(source)
    except ValueError:
        raise BadInput("rows of different lengths; expected channels of one length") from None
    if array.dtype.kind not in "biufc" or array.ndim == 0:
        raise BadInput(f"{source!r:.60}; expected a file, a record, or numbers")
    if array.ndim == 1:
        return [Record.of(array, rate=rate, unit=unit)]
    if array.ndim == 2:
        if array.shape[0] > array.shape[1]:
            raise BadInput(f"an array of shape {array.shape}; expected a row for each channel: use its .T")
        return [Record.of(row, rate=rate, unit=unit, name=f"channel {k}") for k, row in enumerate(array, 1)]
    raise BadInput(f"an array of shape {array.shape}; expected one dimension, or a row for each channel")
