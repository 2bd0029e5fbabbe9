"""The rig: two sprung masses that strike each other across a gap."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from typing import Any

from ._answer import Answer
from ._ask import ask
from ._rig_questions import RigQuestions
from ._words import word, words


class Rig(RigQuestions):
    """Two sprung masses that strike each other across a gap.

    ``Rig(m1=2.0, gap=0.5e-3)`` states masses ``m1``, ``m2`` in kg, springs ``k1``, ``k2`` in N/m, dampers ``c1``,
    ``c2`` in N s/m, ``gap`` in m and ``restitution``; tables such as ``contact={"stiffness": 1e6}`` are
    dictionaries. ``Rig("tool.toml", gap=0.5e-3)`` takes the keys of a TOML file, with some replaced. Keys that are
    left out are those of the thesis' rig: m1 0.125, m2 0.094, k1 135, k2 128, c1 0.1, c2 0.1, gap 1e-3, restitution
    0.7.
    """

    def __init__(
        self, file: str | PathLike[str] | None = None, /, **keys: float | str | Mapping[str, float | str]
    ) -> None:
        self.keys = keys
        """The keys that were stated."""
        self._file: str | None = None if file is None else fspath(file)

    @classmethod
    def from_file(cls, path: str | PathLike[str], **keys: float | str | Mapping[str, float | str]) -> Rig:
        """The rig of a TOML file, with some keys replaced: ``Rig(path, …)``."""
        return cls(path, **keys)

    def _ask(self, command: Sequence[str], options: Mapping[str, Any]) -> Answer:
        return ask(command, [self._file] if self._file else [], {"set": self._stated(), **options})

    def _words(self, command: Sequence[str], options: Mapping[str, Any]) -> list[str]:
        """The words of a command on the rig."""
        return [*command, *words({"set": self._stated(), **options}), *(["--", self._file] if self._file else [])]

    def _stated(self) -> list[str]:
        return [f"{key}={_toml(value)}" for key, value in _flat(self.keys)]

    def __repr__(self) -> str:
        stated = [repr(self._file)] if self._file else []
        return f"Rig({', '.join(stated + [f'{key}={value!r}' for key, value in self.keys.items()])})"


def _flat(keys: Mapping[str, Any], before: str = "") -> list[tuple[str, Any]]:
    """Keys with those of tables behind a dot."""
    flat: list[tuple[str, Any]] = []
    for key, value in keys.items():
        flat += _flat(value, f"{before}{key}.") if isinstance(value, Mapping) else [(before + key, value)]
    return flat


def _toml(value: Any) -> str:
    """A value as TOML."""
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    return word(value)
