"""Bake a greenhouse on a Slurm cluster, from a login node:

    pip install "plant-growth-clips[cluster]" dask-jobqueue
    python on_slurm.py /shared/greenhouse /shared/clips

Both folders, and the environment that this runs in, must be there on all nodes. Jobs come as Slurm
has room for them and go when no plants are left; stopped and started again, it does what is left.
"""

import subprocess
import sys

from dask_jobqueue import SLURMCluster

JOBS = 20  # at most
PARTITION = "normal"


def main(greenhouse: str, clips: str) -> int:
    with SLURMCluster(
        queue=PARTITION,
        cores=16,
        processes=16,  # one plant a process, one process a core
        memory="32GB",  # of a job: 2 GB a plant
        walltime="12:00:00",
        # Workers leave before Slurm ends their job, not all at once.
        worker_extra_args=["--lifetime", "11h", "--lifetime-stagger", "30m"],
        # The profiler's records grow for an hour.
        job_script_prologue=["export DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED=False"],
    ) as cluster:
        cluster.adapt(minimum_jobs=1, maximum_jobs=JOBS)
        command = ["bake", greenhouse, "-o", f"{clips}/", "--cluster", cluster.scheduler_address]
        return subprocess.call(command)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
