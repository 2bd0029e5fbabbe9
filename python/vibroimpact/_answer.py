"""Answers: numbers, findings, tables and figures."""

from __future__ import annotations

import html
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from ._errors import spoken
from ._fields import Fields
from ._figure import Figure
from ._native import Drawing

if TYPE_CHECKING:
    import pandas


class Finding(NamedTuple):
    """What must be known before a number is trusted."""

    severity: str
    """``doubt``, ``caution`` or ``note``."""
    code: str
    """Its code, the same in every version."""
    text: str
    """The sentence."""
    record: str = ""
    """The record that it is about; empty for all."""

    def __str__(self) -> str:
        return f"{self.severity}: {self.record + ': ' if self.record else ''}{self.text}"


def finding(told: tuple[str, str, str], record: str = "") -> Finding:
    """A finding from its severity, code and sentence."""
    severity, code, text = told
    return Finding(severity, code, spoken(text), record)


@dataclass(frozen=True)
class Table:
    """A table of an answer."""

    title: str
    columns: list[tuple[str, str]]
    """Name and unit of each column."""
    rows: list[list[Any]]
    """Cells: numbers, texts, ``None``, or ``(value, std)``."""
    note: str = ""

    def to_pandas(self) -> pandas.DataFrame:
        """A data frame; a column with uncertainties has a second one, named ``… std``."""
        import pandas

        frame: dict[str, list[Any]] = {}
        for k, (name, unit) in enumerate(self.columns):
            named = f"{name} [{unit}]" if unit else name
            cells = [row[k] if k < len(row) else None for row in self.rows]
            frame[named] = [cell[0] if isinstance(cell, tuple) else cell for cell in cells]
            if any(isinstance(cell, tuple) and cell[1] is not None for cell in cells):
                frame[named + " std"] = [cell[1] if isinstance(cell, tuple) else None for cell in cells]
        return pandas.DataFrame(frame)


class Answer(Fields):
    """An answer: its numbers by name, ``findings``, ``tables`` and ``figures``.

    ``answer.frequency`` and ``answer["frequency"]`` are the same; ``print(answer)`` shows its tables. Numbers
    are in SI units; those with an uncertainty are ``Estimate``, lists of numbers arrays of NumPy.
    """

    def __init__(
        self,
        result: dict[str, Any],
        findings: list[tuple[str, tuple[str, str, str]]],
        tables: list[dict[str, Any]],
        text: str,
        figures: list[tuple[str, Drawing]],
    ) -> None:
        super().__init__(result)
        self._kept = (
            [finding(told, record) for record, told in findings],
            [_table(table) for table in tables],
            {name: Figure(name, drawing) for name, drawing in figures},
            text,
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (dict(self), self._kept)

    @property
    def findings(self) -> list[Finding]:
        """What must be known before the numbers are trusted."""
        return self._kept[0]

    @property
    def tables(self) -> list[Table]:
        """The numbers as tables."""
        return self._kept[1]

    @property
    def figures(self) -> dict[str, Figure]:
        """Figures by their names."""
        return self._kept[2]

    def figure(self, name: str | None = None) -> Figure:
        """A figure by its name; the first one without.

        Raises ``KeyError`` where there is none.
        """
        if not self.figures:
            raise KeyError("this answer has no figure")
        if name is not None and name not in self.figures:
            raise KeyError(f"no figure {name!r}; there are {', '.join(self.figures)}")
        return next(iter(self.figures.values())) if name is None else self.figures[name]

    def plot(self, ax: Any = None) -> Any:
        """Draws the first figure with matplotlib, see ``Figure.plot``."""
        return self.figure().plot(ax)

    def __str__(self) -> str:
        told = [str(found) for found in self.findings if found.severity != "note"]
        return "\n".join([self._kept[3].rstrip(), *told]).strip()

    def __repr__(self) -> str:
        return str(self) or f"Answer({', '.join(self)})"

    def _repr_html_(self) -> str:
        figures = "".join(figure._repr_html_() for figure in self.figures.values())
        return f"<pre>{html.escape(str(self))}</pre>{figures}"


def _again(result: dict[str, Any], kept: tuple[Any, ...]) -> Answer:
    """An answer that was pickled."""
    answer = Answer(result, [], [], "", [])
    answer._kept = kept
    return answer


def _table(data: dict[str, Any]) -> Table:
    """A table from its JSON."""
    columns = [(column["name"], column["unit"]) for column in data["columns"]]
    rows = [[_cell(cell) for cell in row] for row in data["rows"]]
    return Table(data["title"], columns, rows, data["note"])


def _cell(cell: Any) -> Any:
    """A cell from its JSON: ``Missing``, or one value by its kind."""
    if isinstance(cell, str):
        return None
    (kind, value), *_ = cell.items()
    return (value["value"], value["std"]) if kind == "Estimate" else value
