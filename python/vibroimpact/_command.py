"""The command ``vibro``."""

import signal
import sys

from ._native import main as _main


def main() -> int:
    """Runs the command line and gives its exit code."""
    # Ctrl+C ends the program: Python's own handler would wait for it to return.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _main(["vibro", *sys.argv[1:]])
