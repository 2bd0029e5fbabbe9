"""The package as a whole: command, campaign, and functions that follow the options."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

import vibroimpact as vi

ROOT = Path(__file__).parents[2]


def command(*words):
    """Runs the command that the package brings."""
    return subprocess.run([sys.executable, "-m", "vibroimpact", *words], capture_output=True, text=True, check=False)


def test_the_command_has_the_version_of_the_module():
    assert command("--version").stdout.split() == ["vibro", vi.__version__]


def test_the_command_says_what_is_wrong():
    wrong = command("decay", "none.csv", "--modes", "x")
    assert wrong.returncode == 2 and "--modes" in wrong.stderr


def test_the_functions_follow_the_options_of_the_commands():
    spec = importlib.util.spec_from_file_location("make_functions", ROOT / "python" / "make_functions.py")
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    installed = Path(vi.__file__).parent
    stale = "options changed: python make_functions.py writes the functions anew"
    assert (installed / "_measure.py").read_text(encoding="utf-8") == made.measure(), stale
    assert (installed / "_rig_questions.py").read_text(encoding="utf-8") == made.rig(), stale


def test_every_public_name_has_a_docstring():
    for name in vi.__all__:
        assert getattr(vi, name).__doc__, name


def test_a_campaign_runs_and_is_written(tmp_path):
    source = ROOT / "examples" / "drop_test"
    for file in source.iterdir():
        if file.is_file():
            (tmp_path / file.name).write_bytes(file.read_bytes())
    done = vi.Campaign(tmp_path / "campaign.toml").run()
    assert done.report.is_file() and "results.json" in " ".join(done.files)
    assert done.answer.tables
    with pytest.raises(vi.BadInput):
        vi.Campaign(tmp_path / "none.toml")
