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

OF_FILES = ("format", "base_band", "decimal", "complex", "wrapped", "columns")
"""Options that say how a file is read."""

Made: TypeAlias = "list[tuple[str, list[tuple[Head, Array]]]]"


def ask(command: Sequence[str], sources: Sequence[Any], options: Mapping[str, Any]) -> Answer:
    """The answer of a command on files and records, with its options."""
    given = dict(options)
    made: Made = []
    places = [_place(source, given, made) for source in sources]
    if made:
        stated = [name for name in OF_FILES if given.get(name)]
        if stated:
            raise BadInput(f"{stated[0]}= says how a file is read, and this record is in memory")
        given.pop("rate", None)
        if any(isinstance(source, np.ndarray) or _is_numbers(source) for source in sources):
            given.pop("unit", None)
    typed = [*command, *words(given)] + (["--", *places] if places else [])
    bar = Bar()
    try:
        answer: Answer = _ask(typed, made, bar)
    finally:
        bar.clear()
    return answer


def _is_numbers(source: Any) -> bool:
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
    array = np.asarray(source)
    if array.dtype.kind not in "biufc":
        raise BadInput(f"{type(source).__name__}; expected a file, a record, or numbers")
    unit = options.get("unit") or ""
    if not isinstance(unit, str):
        raise BadInput("several units for an array; expected one")
    rate = options.get("rate")
    if array.ndim == 1:
        return [Record.of(array, rate=rate, unit=unit)]
    if array.ndim == 2:
        if array.shape[0] > array.shape[1]:
            raise BadInput(f"an array of shape {array.shape}; expected a row for each channel: use its .T")
        return [Record.of(row, rate=rate, unit=unit, name=f"channel {k}") for k, row in enumerate(array, 1)]
    raise BadInput(f"an array of shape {array.shape}; expected one dimension, or a row for each channel")
