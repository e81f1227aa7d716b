#!/bin/bash
# The same as one Slurm job of a fixed size, without dask-jobqueue:
#     sbatch slurm.sh /shared/greenhouse /shared/clips
#SBATCH --job-name=bake
#SBATCH --ntasks=64
#SBATCH --cpus-per-task=1
#SBATCH --mem-per-cpu=2G
#SBATCH --time=12:00:00
set -eu
greenhouse=$1 clips=$2
where=$clips/.scheduler-$SLURM_JOB_ID.json
mkdir -p "$clips"
export DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED=False # its records grow for an hour
trap 'kill $(jobs -p); rm -f "$where"' EXIT
dask scheduler --scheduler-file "$where" --no-dashboard &
srun dask worker --scheduler-file "$where" --nthreads 1 --nworkers 1 --no-dashboard \
    --local-directory "${TMPDIR:-/tmp}" &
until [ -s "$where" ]; do sleep 1; done
bake "$greenhouse" -o "$clips/" --cluster "$where"
