"""Figures: SVG of the report, or drawn by matplotlib."""

from __future__ import annotations

import json
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from ._errors import BadInput
from ._native import Drawing


class Figure:
    """A figure of a record or an answer. A notebook shows it."""

    def __init__(self, name: str, drawing: Drawing) -> None:
        self.name = name
        self._drawing = drawing

    @property
    def title(self) -> str:
        """What it shows, in a few words."""
        return self._drawing.title

    @property
    def caption(self) -> str:
        """Its caption."""
        return self._drawing.caption

    def svg(self) -> str:
        """The drawing as SVG."""
        return self._drawing.svg()

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the drawing into a new file that ends in .svg.

        Raises ``BadInput`` for another ending, ``FileExistsError`` where there is a file of this name.
        """
        if Path(path).suffix.lower() != ".svg":
            raise BadInput(f"{fspath(path)} does not end in .svg; for pixels: .plot().figure.savefig(…)")
        with Path(path).open("x", encoding="utf-8") as file:
            file.write(self.svg())

    def data(self) -> dict[str, Any]:
        """Panels with their axes and series, as numbers."""
        data: dict[str, Any] = json.loads(self._drawing.json())
        return data

    def plot(self, ax: Any = None) -> Any:
        """Draws the panels with matplotlib: the first on ``ax``, or all on a new figure.

        Returns the first axes that were drawn on; ``.figure.axes`` has all. Waterfalls and maps of classes are
        left out: they are in ``svg()``.
        """
        plots = [panel["Plot"] for panel in self.data()["panels"] if "Plot" in panel]
        panels = [plot for plot in plots if plot.get("series") and not plot.get("heatmap")]
        if not panels:
            raise ValueError(f"the figure {self.name} has no panel that matplotlib draws here; use svg()")
        if ax is not None:
            _draw(panels[0], ax)
            return ax
        import matplotlib.pyplot as plt

        _, axes = plt.subplots(len(panels), squeeze=False, layout="constrained")
        for panel, at in zip(panels, axes[:, 0], strict=True):
            _draw(panel, at)
        return axes[0, 0]

    def __reduce__(self) -> tuple[type[Figure], tuple[str, Drawing]]:
        return Figure, (self.name, self._drawing)

    def __repr__(self) -> str:
        return f"<Figure {self.name}: {self.title}>"

    def _repr_html_(self) -> str:
        return f"<figure style='margin:0'>{self.svg()}<figcaption>{self.caption}</figcaption></figure>"


def _draw(panel: dict[str, Any], ax: Any) -> None:
    """Draws one panel."""
    for series in panel.get("series", []):
        label = series["name"] or None
        x, y, low, high = (_numbers(series[key]) for key in ("x", "y", "low", "high"))
        match series["shape"]:
            case "line":
                ax.plot(x, y, label=label)
            case "points":
                if low and high:
                    bars = [[v - a for v, a in zip(y, low)], [b - v for v, b in zip(y, high)]]
                    ax.errorbar(x, y, yerr=bars, fmt="o", label=label)
                else:
                    ax.plot(x, y, "o", label=label)
            case "band":
                ax.fill_between(x, low, high, alpha=0.3, label=label)
            case "bars":
                ax.stairs(y, x, label=label)
            case "vertical":
                ax.axvline(x[0], ls="--", color="grey", label=label)
            case "horizontal":
                ax.axhline(y[0], ls="--", color="grey", label=label)
    for axis, name in ((panel["x"], "x"), (panel["y"], "y")):
        unit = f" [{axis['unit']}]" if axis.get("unit") else ""
        getattr(ax, f"set_{name}label")(axis.get("label", axis.get("name", "")) + unit)
        if str(axis.get("scale", "")).lower().startswith("log") or axis.get("log"):
            getattr(ax, f"set_{name}scale")("log")
    if ax.get_legend_handles_labels()[0]:
        ax.legend()


def _numbers(values: list[float | None]) -> list[float]:
    """Values with NaN for those that are missing."""
    return [float("nan") if value is None else value for value in values]
