"""Frequency response functions."""

from __future__ import annotations

from typing import Any

from ._answer import Answer
from ._ask import Source
from ._measure import spectrum


def frf(record: Source, reference: str | int, **options: Any) -> Answer:
    """Frequency response function of a channel over the channel ``reference``, by name or number from 1.

    The same as ``spectrum`` with ``reference``, whose other arguments it takes. ``modal`` finds its modes.
    """
    return spectrum(record, reference=str(reference), **options)
