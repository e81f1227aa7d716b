"""Bake a greenhouse on Kubernetes, from a pod that has the same volume as the workers:

    pip install "plant-growth-clips[cluster]" dask-kubernetes
    python on_kubernetes.py /data/greenhouse /data/clips

Needs Dask's operator in the cluster, an image with the program (Dockerfile), and a volume that many
pods can write to (kubernetes.yaml, which also runs this as a job).
"""

import os
import subprocess
import sys

from dask_kubernetes.operator import KubeCluster, make_cluster_spec

IMAGE = os.environ.get("IMAGE", "registry.example/plant-growth-clips:0.1.0")
CLAIM = os.environ.get("CLAIM", "greenhouse")
WORKERS = int(os.environ.get("WORKERS", "100"))  # at most
NEEDS = {"cpu": "1", "memory": "2Gi"}  # of a worker: one plant at a time


def cluster_spec() -> dict:
    """The operator's own, with the volume in every worker."""
    spec = make_cluster_spec(
        name="greenhouse",
        image=IMAGE,
        n_workers=1,
        resources={"requests": NEEDS, "limits": NEEDS},
        env={
            "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False",  # its records grow for an hour
            "OMP_NUM_THREADS": "1",
        },
        worker_command="dask-worker --nthreads 1 --memory-limit 2GiB",
    )
    pod = spec["spec"]["worker"]["spec"]
    pod["volumes"] = [{"name": "data", "persistentVolumeClaim": {"claimName": CLAIM}}]
    pod["containers"][0]["volumeMounts"] = [{"name": "data", "mountPath": "/data"}]
    return spec


def main(greenhouse: str, clips: str) -> int:
    with KubeCluster(custom_cluster_spec=cluster_spec()) as cluster:
        cluster.adapt(minimum=1, maximum=WORKERS)
        command = ["bake", greenhouse, "-o", f"{clips}/", "--cluster", cluster.scheduler_address]
        return subprocess.call(command)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
