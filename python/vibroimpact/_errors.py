"""Exceptions: why there is no answer."""

from __future__ import annotations


class VibroError(Exception):
    """No answer. ``code`` names the finding, where it has a code; ``hint`` says what to try."""

    code: str | None
    hint: str

    def __init__(self, text: str, code: str | None = None, hint: str = "") -> None:
        super().__init__(text)
        self.code = code
        self.hint = hint


class Refused(VibroError):
    """The data do not allow an answer."""


class BadInput(VibroError, ValueError):
    """A file, a record or an argument is not what it should be."""
