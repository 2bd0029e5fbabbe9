"""Measurements of impacting machines: instrument files to answers, each with its uncertainty.

    import vibroimpact as vi
    drop = vi.read("drop.csv")                           # records with NumPy arrays, in SI units
    print(vi.restitution("drop.csv", height=0.57))       # numbers with uncertainties, and what to know of them
    vi.Rig(gap=0.5e-3).orbits(frequency=11.2, force=0.5).figure()

Functions on records, files and arrays: ``spectrum``, ``frf``, ``impacts``, ``restitution``, ``pulse``, ``decay``,
``modal``, ``drill``; on sweeps: ``response``, ``waterfall``, ``excitation``; on a model: ``Rig``; on a folder:
``Campaign``. ``help`` of each tells its arguments with units, and what its answer holds.

A number of an answer is an ``Estimate``: ``.value``, ``.std``, ``.unit``, ``.interval()`` (95 %). ``answer.tables``
are what is printed, each with ``.to_pandas()``; ``answer.findings`` is what must be known before it is trusted.
"""

from __future__ import annotations

from . import _progress
from ._answer import Answer, Finding, Table
from ._campaign import Campaign, CampaignRun, demo
from ._errors import BadInput, Refused, VibroError
from ._estimate import Estimate
from ._fields import Fields
from ._figure import Figure
from ._frf import frf
from ._measure import (
    compare,
    decay,
    drill,
    excitation,
    impacts,
    modal,
    pulse,
    response,
    restitution,
    spectrum,
    waterfall,
)
from ._native import limit as _limit
from ._native import version as _version
from ._reading import read
from ._record import Record, Recording, write, write_uff
from ._rig import Rig

__version__ = _version()


def show_progress(shown: bool | None = None) -> None:
    """Shows the progress of long work always, never, or, with ``None``, at a terminal and in a notebook."""
    _progress.shown = shown


def max_memory(size: str) -> None:
    """States the memory that a file and its analysis may take, such as ``"2GB"``; a quarter of the machine's by default.

    Raises ``BadInput`` where it is no size.
    """
    _limit(size)


__all__ = [
    "Answer",
    "BadInput",
    "Campaign",
    "CampaignRun",
    "Estimate",
    "Fields",
    "Figure",
    "Finding",
    "Record",
    "Recording",
    "Refused",
    "Rig",
    "Table",
    "VibroError",
    "compare",
    "decay",
    "demo",
    "drill",
    "excitation",
    "frf",
    "impacts",
    "max_memory",
    "modal",
    "pulse",
    "read",
    "response",
    "restitution",
    "show_progress",
    "spectrum",
    "waterfall",
    "write",
    "write_uff",
]
