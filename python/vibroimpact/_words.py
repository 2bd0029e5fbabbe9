"""Keyword arguments as the words of a command line, which the library checks."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike, fspath
from typing import Any, NamedTuple

import numpy as np

from ._errors import BadInput


class Joined(NamedTuple):
    """Values that are typed as one word with a mark between them."""

    mark: str
    values: Any


def words(options: Mapping[str, Any]) -> list[str]:
    """The words of options; those that are ``None`` or ``False`` are left out."""
    made: list[str] = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            made.append(option)
        elif isinstance(value, Joined):
            if value.values is not None:
                made.append(f"{option}={_joined(value)}")
        elif isinstance(value, (list, tuple)):
            made.extend(f"{option}={word(item)}" for item in value)
        else:
            made.append(f"{option}={word(value)}")
    return made


def word(value: Any) -> str:
    """One value as a word: a number with all its digits."""
    if isinstance(value, (str, PathLike)):
        return fspath(value)
    if isinstance(value, (bool, np.bool_)):
        return str(bool(value)).lower()
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    try:
        return repr(float(value))
    except (TypeError, ValueError):
        raise BadInput(f"{value!r:.60}; expected a number or a name") from None


def _joined(joined: Joined) -> str:
    """Values with their mark between them; a text stands for itself, ``None`` for an open end."""
    mark, values = joined
    if isinstance(values, str) or np.isscalar(values):
        return word(values)
    return mark.join("" if value is None else word(value) for value in values)
