"""docs/examples: the scripts say what the libraries and `bake` understand."""

import runpy
import signal
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

EXAMPLES = Path(__file__).parents[3] / "docs" / "examples"


class FakeCluster:
    """Stands for the cluster that dask-jobqueue or dask-kubernetes would start."""

    scheduler_address = "tcp://scheduler:8786"

    def __init__(self, **asked):
        self.asked = asked
        FakeCluster.last = self

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.closed = True

    def adapt(self, **bounds):
        self.bounds = bounds


def fake_spec(name, image, n_workers, resources, env, worker_command):
    containers = [{"image": image, "args": worker_command.split(), "env": env}]
    return {"metadata": {"name": name}, "spec": {"worker": {"spec": {"containers": containers}}}}


@pytest.fixture
def called(monkeypatch) -> list[list[str]]:
    """The commands that an example runs; none of them is really run."""
    jobqueue, kubernetes = ModuleType("dask_jobqueue"), ModuleType("dask_kubernetes")
    operator = ModuleType("dask_kubernetes.operator")
    jobqueue.SLURMCluster = operator.KubeCluster = FakeCluster
    operator.make_cluster_spec = fake_spec
    for module in (jobqueue, kubernetes, operator):
        monkeypatch.setitem(sys.modules, module.__name__, module)
    commands: list[list[str]] = []
    monkeypatch.setattr(subprocess, "call", lambda command: commands.append(command) or 0)
    return commands


@pytest.mark.parametrize("name", ["on_slurm", "on_kubernetes"])
def test_an_example_bakes_on_the_cluster_it_starts(name, called):
    example = runpy.run_path(str(EXAMPLES / f"{name}.py"))
    assert example["main"]("/data/greenhouse", "/data/clips") == 0
    expected = "bake /data/greenhouse -o /data/clips/ --cluster tcp://scheduler:8786"
    assert called == [expected.split()]
    assert FakeCluster.last.bounds
    assert FakeCluster.last.closed


def test_workers_on_kubernetes_have_the_volume(called):
    runpy.run_path(str(EXAMPLES / "on_kubernetes.py"))["main"]("/data/a", "/data/b")
    pod = FakeCluster.last.asked["custom_cluster_spec"]["spec"]["worker"]["spec"]
    (mount,) = pod["containers"][0]["volumeMounts"]
    assert mount["name"] == pod["volumes"][0]["name"]
    yaml = pytest.importorskip("yaml")
    parts = list(yaml.safe_load_all((EXAMPLES / "kubernetes.yaml").read_text()))
    claim, job = parts[0], parts[-1]["spec"]["template"]["spec"]
    assert pod["volumes"] == [v | {"name": "data"} for v in job["volumes"]]
    assert claim["metadata"]["name"] == pod["volumes"][0]["persistentVolumeClaim"]["claimName"]
    assert [part["kind"] for part in parts].count("Job") == 1


def test_the_job_of_fixed_size_is_a_script():
    subprocess.run(["bash", "-n", str(EXAMPLES / "slurm.sh")], check=True)


def test_slurm_takes_what_the_example_asks_for(called, monkeypatch):
    runpy.run_path(str(EXAMPLES / "on_slurm.py"))["main"]("/data/a", "/data/b")
    monkeypatch.delitem(sys.modules, "dask_jobqueue")
    usual = signal.getsignal(signal.SIGINT)
    jobqueue = pytest.importorskip("dask_jobqueue", reason="dask-jobqueue is not installed")
    signal.signal(signal.SIGINT, usual)  # loading it puts a handler of its own in place
    asked = FakeCluster.last.asked
    script = jobqueue.slurm.SLURMJob("tcp://scheduler:1", "name", **asked).job_script()
    assert "--nworkers 16" in script
    assert "--nthreads 1" in script
