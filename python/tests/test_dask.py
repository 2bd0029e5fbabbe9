"""Studies in parts: in one process, and on a cluster of which a worker is killed."""

from __future__ import annotations

import os
import signal
from typing import Any

import numpy as np
import pytest

import vibroimpact as vi
from vibroimpact._native import merged, part, study

MAP: dict[str, Any] = {"x": ("frequency", 4, 14, 30), "y": ("restitution", 0.3, 0.95, 20), "force": 0.5}
DRAWS: dict[str, Any] = {"from_": 5.0, "to": 14.0, "points": 10, "force": 0.5, "monte_carlo": 100}


def test_parts_in_any_order_give_the_answer_of_one_run() -> None:
    words = ["model", "map", "--x", "frequency:4:14:30", "--y", "restitution:0.3:0.95:20", "--force", "0.5"]
    text = study(words)
    answer = merged([part(text, f"{number}/3", None) for number in (2, 3, 1)])
    one = vi.Rig().map(**MAP)
    assert np.array_equal(answer.spectral_radius, one.spectral_radius, equal_nan=True)
    assert str(answer) == str(one)
    with pytest.raises(vi.BadInput, match=r"1 of 3 parts is missing: 2"):
        merged([part(text, f"{number}/3", None) for number in (1, 3)])
    with pytest.raises(vi.BadInput, match="one cell"):
        study(["model", "orbit", "--force", "0.5", "--frequency", "11"])


def test_a_cluster_gives_the_answer_of_one_run_though_a_worker_dies() -> None:
    distributed = pytest.importorskip("distributed")
    import vibroimpact.dask

    rig = vi.Rig(uncertainty={"gap": 5e-5})
    local = distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50)
    with local as cluster, distributed.Client(cluster) as client:
        doomed = next(iter(client.run(os.getpid).values()))
        killed = client.submit(lambda: None)
        killed.add_done_callback(lambda _: os.kill(doomed, signal.SIGKILL))
        on_cluster = vibroimpact.dask.map(vi.Rig(), client=client, parts=40, **MAP)
        drawn = vibroimpact.dask.response(rig, client=client, **DRAWS)
        with pytest.raises(vi.BadInput, match="no uncertainty to draw from"):
            vibroimpact.dask.response(vi.Rig(), client=client, **DRAWS)
    one = vi.Rig().map(**MAP)
    assert np.array_equal(on_cluster.spectral_radius, one.spectral_radius, equal_nan=True)
    assert str(on_cluster) == str(one)
    assert str(drawn) == str(rig.response(**DRAWS))
