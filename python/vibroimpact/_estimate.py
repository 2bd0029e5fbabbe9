"""A value with its standard uncertainty."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist


@dataclass(frozen=True)
class Estimate:
    """A value with its standard uncertainty, which prints as ``5.51446(45) Hz``.

    ``float(estimate)`` is its value, and values are compared. There is no arithmetic: numbers of one answer
    are correlated, so that their uncertainties do not add as those of independent ones.
    """

    value: float
    """Best value, in ``unit``; NaN where there is none."""
    std: float | None
    """Standard uncertainty, in ``unit``; ``None`` where it is not known."""
    unit: str = ""
    """SI unit."""
    n: int = 1
    """Number of samples, lines or points used."""
    method: str = ""
    """Method of estimation."""

    def __post_init__(self) -> None:
        if self.value is None:
            object.__setattr__(self, "value", math.nan)

    def interval(self, probability: float = 0.95) -> tuple[float, float]:
        """Lower and upper end of the interval that holds the truth with this probability.

        Errors are taken as normal. Raises ``ValueError`` where the uncertainty is not known.
        """
        if self.std is None:
            raise ValueError(f"the uncertainty of {self} is not known: the findings say why")
        if not 0.0 < probability < 1.0:
            raise ValueError(f"a probability of {probability}; expected one between 0 and 1")
        half = NormalDist().inv_cdf(0.5 + 0.5 * probability) * self.std
        return self.value - half, self.value + half

    def __float__(self) -> float:
        return float(self.value)

    def __lt__(self, other: float | Estimate) -> bool:
        return float(self) < float(other)

    def __le__(self, other: float | Estimate) -> bool:
        return float(self) <= float(other)

    def __gt__(self, other: float | Estimate) -> bool:
        return float(self) > float(other)

    def __ge__(self, other: float | Estimate) -> bool:
        return float(self) >= float(other)

    def __str__(self) -> str:
        unit = "" if self.unit in ("", "1") else f" {self.unit}"
        return _with_digits(self.value, self.std) + unit

    def __format__(self, spec: str) -> str:
        return format(self.value, spec) if spec else str(self)

    def _repr_html_(self) -> str:
        return f"<code>{self}</code>"


def _with_digits(value: float, std: float | None) -> str:
    """The value with two digits of its uncertainty in brackets."""
    if std is None or not math.isfinite(value):
        return f"{value:.6g}"
    if not std > 0.0:
        return f"{value:.6g}(0)"
    # Two digits of the uncertainty, after it was rounded to two.
    places = 1 - math.floor(math.log10(float(f"{std:.1e}")))
    size = max(abs(value), std)
    if size >= 1e6 or size < 1e-4:
        power = math.floor(math.log10(size))
        inner = _with_digits(value / 10.0**power, std / 10.0**power)
        return f"{inner}e{power}"
    if places <= 0:
        step = 10**-places
        return f"{round(value / step) * step}({round(std / step) * step})"
    return f"{value:.{places}f}({_in_brackets(std, places)})"


def _in_brackets(std: float, places: int) -> str:
    """The uncertainty in units of the last of ``places`` digits; with its point if it reaches above it."""
    if std >= 1.0:
        return f"{std:.{places}f}"
    return str(round(std * 10**places))
