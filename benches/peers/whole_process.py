"""The time that a whole process takes."""

import subprocess
import time


def fastest(command):
    """Least time in ms of seven runs, start-up included."""
    took = []
    for _ in range(7):
        start = time.perf_counter()
        subprocess.run(command, check=True, capture_output=True)
        took.append(time.perf_counter() - start)
    return min(took) * 1e3
