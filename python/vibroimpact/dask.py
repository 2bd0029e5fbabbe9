"""Maps and Monte Carlos in parts, on the workers of a Dask cluster.

    from dask.distributed import Client, LocalCluster
    import vibroimpact as vi
    import vibroimpact.dask

    client = Client(LocalCluster(n_workers=4, threads_per_worker=1))
    answer = vi.dask.map(vi.Rig(), x=("frequency", 4, 14, 300), y=("restitution", 0.3, 0.95, 200), force=0.5, client=client)

The answer is that of ``Rig.map``, bit for bit: the bytes of a cell depend on its number alone. A part whose worker
dies is computed by another one. Workers need this package and no files; each uses as many cores as it has threads,
or as ``RAYON_NUM_THREADS`` states.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from ._answer import Answer
from ._native import merged as _merged
from ._native import part as _native_part
from ._native import study as _study
from ._rig import Rig
from ._rig_questions import RigQuestions


class Client(Protocol):
    """What is asked of ``dask.distributed.Client``."""

    def nthreads(self) -> Mapping[str, int]: ...
    def map(self, function: Any, *arguments: Sequence[Any]) -> Any: ...
    def gather(self, futures: Any) -> Any: ...
    def cancel(self, futures: Any) -> Any: ...


PARTS_A_THREAD = 8
"""Parts for each thread of the cluster: a slow part then delays the end by an eighth at most."""


class _Studied(RigQuestions):
    """Turns the questions to a rig into studies, which are computed elsewhere."""

    def __init__(self, rig: Rig) -> None:
        self._rig = rig
        self.study = ""

    def _ask(self, command: Sequence[str], options: Mapping[str, Any]) -> Any:
        self.study = _study(self._rig._words(command, options))


def map(rig: Rig, *, client: Client, parts: int | None = None, **options: Any) -> Answer:
    """The answer of ``Rig.map`` with these options, its cells computed by the workers of ``client``.

    ``parts`` is the number of parts; by default eight for each thread of the workers. Raises as ``Rig.map`` does.
    """
    studied = _Studied(rig)
    studied.map(**options)
    return _answered(studied.study, client, parts)


def response(rig: Rig, *, client: Client, parts: int | None = None, **options: Any) -> Answer:
    """The answer of ``Rig.response`` with ``monte_carlo=N``, its draws computed by the workers of ``client``.

    ``parts`` is the number of parts; by default eight for each thread of the workers. Raises as ``Rig.response``
    does.
    """
    studied = _Studied(rig)
    studied.response(**options)
    return _answered(studied.study, client, parts)


def _part(study: str, shard: str) -> bytes:
    """The cells of a part, on a worker."""
    from distributed import get_worker

    # Read once, when the first part of a process begins.
    os.environ.setdefault("RAYON_NUM_THREADS", str(get_worker().state.nthreads))
    return _native_part(study, shard, None)


def _answered(study: str, client: Client, parts: int | None) -> Answer:
    if parts is None:
        parts = PARTS_A_THREAD * max(1, sum(client.nthreads().values()))
    shards = [f"{number}/{parts}" for number in range(1, parts + 1)]
    futures = client.map(_part, [study] * parts, shards)
    try:
        answer: Answer = _merged(client.gather(futures))
    finally:
        # Nobody waits for the rest after an error or Ctrl+C.
        client.cancel(futures)
    return answer
