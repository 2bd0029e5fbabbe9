#!/bin/bash
# Runs the recipes of this folder with tasks that are killed, and compares with one run:  clusters/try.sh [slurm] [snakemake] [dask]
# Needs `vibro` on the path, and for each engine its programs: sbatch, snakemake, or Python with vibroimpact and distributed.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
[ $# -gt 0 ] || set -- slurm snakemake dask
work=$(mktemp -d)
cd "$work"
options=$(sed -n 's/^exec vibro \(.*\) \\$/\1/p' "$here/map.sh")
# shellcheck disable=SC2086
vibro $options --out whole >/dev/null
say() { printf '%s  %s\n' "$(date +%T)" "$*"; }

# Waits until a part has cells; its process and file.
begun() {
  file=parts/part_$(printf %02d "$1")_of_16.cells
  for _ in $(seq 600); do
    pid=$(pgrep -f -- "--shard $1/16 " | head -1) && [ -s "$file" ] && return
    sleep 0.02
  done
  say "part $1 did not begin"
  exit 1
}

# Ends the process that computes a part without a chance to do anything.
kill_part() {
  begun "$1"
  kill -9 "$pid" && say "killed part $1, process $pid, $(stat -c %s "$file") bytes written"
}

same() {
  vibro merge parts --out map >/dev/null
  diff -r whole map && say "$1: byte for byte as one run"
  rm -rf parts map done
}

for engine in "$@"; do
  case $engine in
  slurm)
    wait_for() { while [ -n "$(squeue -h -j "$1" 2>/dev/null)" ]; do sleep 0.5; done; }
    job=$(sbatch --parsable "$here/map.sh")
    say "submitted $job"
    kill_part 2
    begun 4
    scontrol requeue "${job}_4" && say "requeued part 4, $(stat -c %s "$file") bytes written"
    # Slurm lets a requeued task wait for two minutes.
    sleep 1
    scontrol update "JobId=${job}_4" StartTime=now
    wait_for "$job"
    cat "map_${job}_4.log"
    list=$(vibro merge parts --missing)
    say "missing: $list"
    # shellcheck disable=SC2086
    job=$(sbatch --parsable $list "$here/map.sh")
    wait_for "$job"
    cat "map_${job}"_*.log
    say "missing: $(vibro merge parts --missing 2>&1)"
    same slurm
    ;;
  snakemake)
    snakemake --snakefile "$here/Snakefile" --directory . --cores 2 >snakemake.log 2>&1 &
    kill_part 3
    wait $!
    grep -E 'Trying to restart|Error in rule|steps \(100%\)|cells were there' snakemake.log
    rm -rf map
    same snakemake
    ;;
  dask)
    cat >try.py <<'END'
import os, signal, threading, time
import numpy as np
import vibroimpact as vi
import vibroimpact.dask
from dask.distributed import Client, LocalCluster

if __name__ == "__main__":
    options = {"x": ("frequency", 4, 14, 300), "y": ("restitution", 0.3, 0.95, 100), "force": 0.5}
    with LocalCluster(n_workers=3, threads_per_worker=1, silence_logs=50) as cluster, Client(cluster) as client:
        workers = list(client.run(os.getpid).values())

        def kill() -> None:
            time.sleep(1.5)
            os.kill(workers[0], signal.SIGKILL)
            print(time.strftime("%T"), " killed worker", workers[0], flush=True)

        threading.Thread(target=kill).start()
        answer = vi.dask.map(vi.Rig(), client=client, **options)
    whole = np.load("whole/map.npy")["spectral_radius"]
    assert np.array_equal(answer.spectral_radius, whole, equal_nan=True)
    print(time.strftime("%T"), " dask: number for number as one run")
END
    python try.py
    ;;
  esac
done
rm -rf "$work"
