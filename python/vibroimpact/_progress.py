"""Progress of long work on standard error."""

from __future__ import annotations

import sys
import time

SHOWN_AFTER = 1.0
"""Seconds after which work shows its progress."""

shown: bool | None = None
"""Whether progress is shown: ``None`` where a person looks, at a terminal or in a notebook."""


class Bar:
    """A line that is written anew at each call."""

    def __init__(self) -> None:
        self._began = time.monotonic()
        self._width = 0

    def __call__(self, what: str, done: int, whole: int) -> None:
        seconds = time.monotonic() - self._began
        if seconds < SHOWN_AFTER or not _wanted():
            return
        part = done / whole if whole else 0.0
        filled = int(20 * min(part, 1.0))
        bar = "█" * filled + "·" * (20 - filled)
        of = f"{bar} {done}/{whole}" if whole else ""
        line = f"{what} {of} {seconds:.0f} s"
        print("\r" + line.ljust(self._width), end="", file=sys.stderr, flush=True)
        self._width = len(line)

    def clear(self) -> None:
        """Removes the line."""
        if self._width:
            print("\r" + " " * self._width + "\r", end="", file=sys.stderr, flush=True)


def _wanted() -> bool:
    return shown if shown is not None else sys.stderr.isatty() or "ipykernel" in sys.modules
