"""Exceptions: why there is no answer."""

from __future__ import annotations

import re


class VibroError(Exception):
    """No answer. ``code`` names the finding, where it has a code; ``hint`` says what to try."""

    code: str | None
    hint: str

    def __init__(self, text: str, code: str | None = None, hint: str = "") -> None:
        super().__init__(spoken(text))
        self.code = code
        self.hint = spoken(hint)

    def __reduce__(self) -> tuple[type[VibroError], tuple[str, str | None, str]]:
        return type(self), (str(self), self.code, self.hint)


class Refused(VibroError):
    """The data do not allow an answer."""


class BadInput(VibroError, ValueError):
    """A file, a record or an argument is not what it should be."""


def spoken(text: str) -> str:
    """A message for a person at a command line, with functions and keyword arguments in place of its words."""

    def called(found: re.Match[str]) -> str:
        name, rest = found[1], (found[2] or "").strip()
        name = _FUNCTIONS.get(name, name)
        if rest == "--help":
            return f"help(vibroimpact.{name})"
        if name == "Campaign" and rest:
            return f"vibroimpact.Campaign({rest!r}).run()"
        return f"vibroimpact.{name}" + (f" ({rest})" if rest else "")

    def argument(found: re.Match[str]) -> str:
        name, value = found[1].replace("-", "_"), (found[2] or "").strip(" =")
        if name == "max_memory":
            return f"vibroimpact.max_memory({value!r})"
        if value in ("is", "stands", "has", "needs", "without", "in", "and", "or", "to"):
            return f"{name} {value}"
        if not value or re.fullmatch(r"<.*>|[A-Z:]+", value):
            return f"{name}="
        return f"{name}={value if _NUMBER.fullmatch(value) else repr(value)}"

    text = re.sub(r"(?<![\w/.-])vibro --help", "help(vibroimpact)", text)
    text = re.sub(r"\bvibro needs <([A-Z]+)>\.*", lambda found: f"no {found[1].lower()} is named", text)
    text = re.sub(r"(?<![\w/.-])vibro (" + "|".join(_COMMANDS) + r")(?![\w/.-])( [^\s`,;()]+)?", called, text)
    text = re.sub(r"(?<![\w/.-])--([a-z][a-z-]+)(?![\w./])((?:=| )(?:<[^>]*>|[^\s`,;()]+))?", argument, text)
    return re.sub(r"try: ls\b *(.*)", lambda found: f"try: os.listdir({found[1] or '.'!r})", text)


_COMMANDS = (
    *("info", "convert", "spectrum", "modal", "impacts", "restitution", "pulse", "decay", "drill", "response"),
    *("waterfall", "excitation", "compare", "model", "run", "init", "demo"),
)
_NUMBER = re.compile(r"[+-]?[0-9.]+(e[+-]?[0-9]+)?")
_FUNCTIONS = {"info": "read", "convert": "write", "model": "Rig", "init": "Campaign", "run": "Campaign"}
