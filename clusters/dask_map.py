"""A map on the workers of a Dask cluster, here on the cores of one machine:  python dask_map.py"""

import vibroimpact as vi
import vibroimpact.dask
from dask.distributed import Client, LocalCluster

if __name__ == "__main__":
    with LocalCluster(threads_per_worker=1) as cluster, Client(cluster) as client:
        options = {"x": ("frequency", 4, 14, 300), "y": ("restitution", 0.3, 0.95, 100), "force": 0.5}
        answer = vi.dask.map(vi.Rig(), client=client, **options)
    print(answer)
