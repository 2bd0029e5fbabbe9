"""Campaigns: a folder of recordings with what is to be measured in each."""

from __future__ import annotations

from os import PathLike, fspath
from pathlib import Path

from ._answer import Answer
from ._errors import BadInput
from ._native import demo as _demo
from ._native import run as _run
from ._progress import Bar
from ._words import words


class CampaignRun:
    """A run of a campaign: its answer, and the files in its folder of results."""

    def __init__(self, answer: Answer, folder: Path, files: list[str]) -> None:
        self.answer = answer
        """All answers: numbers by section, findings, tables, figures."""
        self.folder = folder
        """The folder of the results; ``report.html`` there is the report."""
        self.files = files
        """Names of the files that were written."""

    @property
    def report(self) -> Path:
        """The report, a page for a browser."""
        return self.folder / "report.html"

    def __repr__(self) -> str:
        return f"{self.answer!r}\n{len(self.files)} files in {self.folder}; open report.html there"

    def _repr_html_(self) -> str:
        return self.answer._repr_html_()


class Campaign:
    """A campaign file, or a folder of recordings."""

    def __init__(self, path: str | PathLike[str]) -> None:
        self.path = Path(path)
        """The campaign file, or the folder."""
        if not self.path.exists():
            raise BadInput(f"{self.path} does not exist; expected a campaign file or a folder of recordings")

    def run(
        self, *, out: str | PathLike[str] | None = None, again: bool = False, allow_outside: bool = False
    ) -> CampaignRun:
        """Measures all records and writes the results, as the command ``vibro run`` does.

        Arguments:
            out: Folder for the results; by default ``out`` of the campaign, else ``results`` beside it.
            again: Compute everything anew, even what has not changed since the last run.
            allow_outside: Allow files outside the folder of the campaign.

        Raises ``BadInput`` where the campaign or its files cannot be read, or a file of somebody else would be
        replaced.
        """
        options = {"out": out, "again": again, "allow_outside": allow_outside}
        bar = Bar()
        try:
            answer, folder, files = _run([*words(options), "--", fspath(self.path)], bar)
        finally:
            bar.clear()
        return CampaignRun(answer, Path(folder), files)

    def __repr__(self) -> str:
        return f"Campaign({str(self.path)!r})"


def demo(name: str, folder: str | PathLike[str] | None = None) -> Campaign:
    """Writes an example with its recordings into ``folder``, by default one of its name: its campaign.

    There are ``two_mass_rig``, ``bench``, ``drop_test`` and ``hammer_drill``.

    Raises ``BadInput`` where there is no such example, or a file of it is there with other content.
    """
    return Campaign(_demo(name, None if folder is None else fspath(folder)))
