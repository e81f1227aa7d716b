"""`--cluster`: a real scheduler and two worker processes, one of which is killed in the middle."""

import concurrent.futures
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest

from baker.batch import workers
from baker.batch.bake_all import bake_plants
from baker.batch.plant import PlantJob, bake_plant
from baker.cli import main
from baker.errors import InputError
from baker.options import Options, Outputs
from tests.baker.batch.conftest import write_greenhouse

distributed = pytest.importorskip("distributed")

PLANTS = [f"p{k:02d}" for k in range(10)]


@dataclass(frozen=True)
class Cluster:
    """address: of its scheduler; workers: two processes; scheduler: another."""

    address: str
    scheduler: subprocess.Popen
    workers: list[subprocess.Popen]


@pytest.fixture(scope="module")
def cluster(tmp_path_factory) -> Iterator[Cluster]:
    folder = tmp_path_factory.mktemp("cluster")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"

    def start(kind: str, *arguments: str) -> subprocess.Popen:
        module = f"distributed.cli.dask_{kind}"
        return subprocess.Popen(
            [sys.executable, "-m", module, *arguments, "--no-dashboard"],
            cwd=folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": os.getcwd(), "OMP_NUM_THREADS": "1"},
        )

    scheduler = start("scheduler", "--host", "127.0.0.1", "--port", address.rpartition(":")[2])
    common = ("--nthreads", "1", "--no-nanny", "--local-directory", str(folder))
    workers = [start("worker", address, *common) for _ in range(2)]
    try:
        with distributed.Client(address, timeout=120, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=120)
        yield Cluster(address, scheduler, workers)
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()


@pytest.fixture(scope="module")
def house(tmp_path_factory) -> Path:
    return write_greenhouse(tmp_path_factory.mktemp("plants") / "house", PLANTS, days=3)


@pytest.fixture(scope="module")
def clips(house, tmp_path_factory) -> dict[str, bytes]:
    """What each plant alone bakes to, here."""
    folder = tmp_path_factory.mktemp("alone")
    options = Options(align="none", workers=1)
    clips = {plant: folder / f"{plant}.gclip" for plant in PLANTS}
    jobs = [PlantJob(p, house / p, options, Outputs(clip)) for p, clip in clips.items()]
    assert all(bake_plant(job).state == "baked" for job in jobs)
    return {clip.name: clip.read_bytes() for clip in clips.values()}


def bake(inputs: Path, output: str, address: str, *more: str) -> int:
    return main([str(inputs), "-o", output, "--align", "none", "--cluster", address, *more])


def files(folder: Path) -> dict[str, bytes]:
    return {
        path.name: path.read_bytes() for path in folder.iterdir() if not path.name.startswith(".")
    }


def test_nobody_can_reach_a_command_that_uses_a_cluster(cluster, house, tmp_path, monkeypatch):
    """Neither a scheduler nor a page about it is started: nothing here waits for connections."""
    listening = []
    monkeypatch.setattr(socket.socket, "listen", lambda one, *_: listening.append(one))
    assert bake(house / "p05", f"{tmp_path}/", cluster.address, "-q") == 0
    assert not listening


def test_one_plant_alone_is_not_for_a_cluster(house, tmp_path, capsys):
    assert bake(house / "p04", str(tmp_path / "plant.gclip"), "127.0.0.1:1") == 2
    assert "--cluster is for many plants" in capsys.readouterr().err


def test_a_worker_of_another_version_is_told(cluster, house, tmp_path, monkeypatch, capsys):
    packages = workers.software()["packages"] | {"numpy": "0.9"}
    ours = {**workers.software(), "packages": packages}
    monkeypatch.setattr(workers, "software", lambda: ours)
    assert bake(house, f"{tmp_path}/", cluster.address) == 2
    said = capsys.readouterr().err
    assert "The cluster's worker tcp://127.0.0.1:" in said
    assert "but here it is numpy 0.9; install" in said


def test_ctrl_c_stops_the_cluster_too(cluster, house, tmp_path):
    words = [house, "-o", f"{tmp_path}/", "--align", "none", "--cluster", cluster.address]
    command = [sys.executable, "-m", "baker", *map(str, words)]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    process.stderr.readline()  # the first plant is done
    process.send_signal(signal.SIGINT)
    rest = process.stderr.read()
    assert process.wait(timeout=120) == 130
    assert rest.strip().splitlines()[-1].startswith("bake: stopped")
    assert "Traceback" not in rest
    with distributed.Client(cluster.address, set_as_default=False) as client:
        tasks = client.run_on_scheduler(lambda dask_scheduler: len(dask_scheduler.tasks))
    assert tasks == 0


def test_a_worker_killed_in_the_middle_loses_nothing(cluster, house, clips, tmp_path, capsys):
    over = threading.Event()

    def kill() -> None:
        while not any(tmp_path.glob("*.gclip")) and not over.wait(0.005):
            pass
        cluster.workers[0].kill()

    killer = threading.Thread(target=kill)
    killer.start()
    try:
        assert bake(house, f"{tmp_path}/", cluster.address) == 0, capsys.readouterr().err
    finally:
        over.set()
        killer.join()
    assert cluster.workers[0].wait() == -signal.SIGKILL
    # A clip that the killed worker had just written stands, and is told as unchanged.
    told = capsys.readouterr().err
    assert "\n10 plants: " in told
    assert "failed" not in told
    assert files(tmp_path) == clips


def test_nobody_there_is_told_soon(house, tmp_path, capsys):
    with socket.socket() as silent:  # bound, never listening
        silent.bind(("127.0.0.1", 0))
        address = f"127.0.0.1:{silent.getsockname()[1]}"
        assert bake(house, f"{tmp_path}/", address) == 2
    assert f"{address}: no scheduler answers" in capsys.readouterr().err


def test_without_dask_it_is_told_how_to_install_it(house, tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert bake(house, f"{tmp_path}/", "127.0.0.1:1") == 2
    assert 'pip install "plant-growth-clips[cluster]"' in capsys.readouterr().err


def submit_failing(error: Exception, bake: object, job: PlantJob) -> concurrent.futures.Future:
    task: concurrent.futures.Future = concurrent.futures.Future()
    task.set_exception(error)
    return task


def test_a_plant_that_kills_worker_after_worker_fails_alone(tmp_path):
    job = PlantJob("p", tmp_path, Options(), Outputs(tmp_path / "p.gclip"))
    killed = distributed.KilledWorker("task", SimpleNamespace(address="tcp://w:1"), 3)
    (outcome,) = bake_plants(partial(submit_failing, killed), [job])
    assert (outcome.state, outcome.code) == ("failed", 1)
    assert "4 different workers" in outcome.error
    assert "try fewer points" in outcome.error


def test_a_scheduler_that_goes_is_told(tmp_path):
    job = PlantJob("p", tmp_path, Options(), Outputs(tmp_path / "p.gclip"))
    gone = concurrent.futures.CancelledError()
    with pytest.raises(InputError, match="The cluster's scheduler is gone"):
        list(bake_plants(partial(submit_failing, gone), [job]))


@pytest.mark.parametrize(
    "error",
    [
        ModuleNotFoundError("No module named 'baker'"),
        RuntimeError("Error during deserialization of the task graph. This frequently occurs"),
    ],
)
def test_a_cluster_without_the_program_is_told(error):
    class Client:
        def submit(self, function, pure):
            raise error

    with pytest.raises(InputError, match=r"lacks the program \([\w' ]+\); install it"):
        workers.require_same_versions(Client())
