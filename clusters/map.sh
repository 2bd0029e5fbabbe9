#!/bin/bash
# A map in 16 parts as a job array of Slurm:  sbatch map.sh
# Only what is missing:  list=$(vibro merge parts --missing) && sbatch $list map.sh
#SBATCH --job-name=map
#SBATCH --array=1-16
#SBATCH --cpus-per-task=1
#SBATCH --mem=500M
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=%x_%A_%a.log
# The number of parts stands here too: a later array of some tasks does not change it.
export RAYON_NUM_THREADS=$SLURM_CPUS_PER_TASK
exec vibro model map --force 0.5 --x frequency:4:14:300 --y restitution:0.3:0.95:100 \
  --shard "$SLURM_ARRAY_TASK_ID/16" --out parts
