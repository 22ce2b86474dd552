"""Clusters: jobs that are submitted to a head node, nodes that are lost, drivers that are."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from islands import session
from islands.config import load_config
from meshops.examples import plate
from meshops.formats import write_mesh
from tests.jobs import SMALL, finish, job
from tracking.events import Event, RoundReport

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]

ray = pytest.importorskip("ray")

BIN = Path(sys.executable).parent
QUIET = {
    "RAY_USAGE_STATS_ENABLED": "0",
    "RAY_AUTH_MODE": "disabled",
    "RAY_ENABLE_UV_RUN_RUNTIME_ENV": "0",
}
OPTIONS = ("--size", "5", "--criteria", "paper")


def free_port() -> int:
    with socket.socket() as some:
        some.bind(("127.0.0.1", 0))
        return int(some.getsockname()[1])


def ended(process: subprocess.Popen[bytes]) -> None:
    process.send_signal(signal.SIGTERM)
    try:
        process.wait(30)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def answers(port: int, seconds: float = 90.0) -> bool:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            socket.create_connection(("127.0.0.1", port), 1.0).close()
        except OSError:
            time.sleep(0.2)
        else:
            return True
    return False


@pytest.fixture(scope="module")
def head() -> Iterator[str]:
    """The address of the dashboard of a head node that was started for these tests."""
    port, dashboard, client, agent = (free_port() for _ in range(4))
    with tempfile.TemporaryDirectory(prefix="r") as short:
        process = subprocess.Popen(
            [
                str(BIN / "ray"), "start", "--head", "--block", f"--port={port}",
                "--dashboard-host=127.0.0.1", f"--dashboard-port={dashboard}",
                f"--ray-client-server-port={client}", f"--dashboard-agent-listen-port={agent}",
                "--num-cpus=2", f"--temp-dir={short}",
            ],
            env={**os.environ, **QUIET, "PATH": f"{BIN}:{os.environ['PATH']}"},
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        try:
            assert answers(dashboard)
            yield f"http://127.0.0.1:{dashboard}"
        finally:
            ended(process)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """An MLflow server."""
    folder, port = tmp_path_factory.mktemp("mlflow"), free_port()
    process = subprocess.Popen(
        [
            str(BIN / "mlflow"), "server", "--host", "127.0.0.1", "--port", str(port),
            "--workers", "1", "--backend-store-uri", f"sqlite:///{folder}/mlflow.db",
            "--artifacts-destination", str(folder / "artifacts"),
        ],
        env={**os.environ, "MLFLOW_SERVER_ENABLE_JOB_EXECUTION": "false"},
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        assert answers(port)
        yield f"http://127.0.0.1:{port}"
    finally:
        ended(process)


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("sound")
    write_mesh(plate(), folder / "plate.bdf")
    config = load_config(None, {**SMALL, "track": "off"})
    done = session.optimize(folder / "plate.bdf", folder / "run", config, lambda _: [], overwrite=False)  # fmt: skip # noqa: E501
    return done.mesh.digest


def submitted(head: str, folder: Path, *arguments: str) -> tuple[int, str]:
    done = subprocess.run(
        [
            str(BIN / "ray"), "job", "submit", "--address", head, "--working-dir", str(folder),
            "--", "meshipelago", *arguments,
        ],
        env={**os.environ, **QUIET}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    return done.returncode, done.stdout + done.stderr


def digest_of(folder: Path) -> str:
    return str(json.loads((folder / "result.json").read_text())["digest"])


def test_a_job_that_is_submitted_to_a_head_node(
    head: str, server: str, sound: str, tmp_path: Path
) -> None:
    """The deck travels with the job, progress is in its log, results and record are outside."""
    deck, results = tmp_path / "deck", tmp_path / "results"
    deck.mkdir()
    write_mesh(plate(), deck / "plate.bdf")
    code, log = submitted(
        head, deck, "optimize", "plate.bdf", "--out", str(results), "--backend", "ray",
        "--track", server, *OPTIONS,
    )  # fmt: skip
    assert code == 0, log
    assert digest_of(results) == sound
    assert re.search(r"generation \d+  island 1", log)
    assert "failed elements -> 0" in log
    from mlflow import MlflowClient

    client = MlflowClient(server)
    experiment = client.get_experiment_by_name("meshipelago")
    runs = client.search_runs([experiment.experiment_id])
    assert {run.info.status for run in runs} == {"FINISHED"}
    assert len(runs) == 3  # the whole and two islands
    code, log = submitted(head, deck, "optimize", "plate.bdf", "--out", "here", *OPTIONS)
    assert code != 0
    assert "name an absolute path" in log


def test_a_job_that_is_tried_again_goes_on(head: str, sound: str, tmp_path: Path) -> None:
    """As KubeRay does it: the first driver is killed, the second one gets the same command."""
    deck, results = tmp_path / "deck", tmp_path / "results"
    deck.mkdir()
    write_mesh(plate(), deck / "plate.bdf")
    command = (
        "optimize", "plate.bdf", "--out", str(results), "--backend", "ray", "--track", "off",
        "--resume", *OPTIONS,
    )  # fmt: skip

    def kill_the_driver() -> None:
        end = time.monotonic() + 120
        while not (results / "checkpoint.arrow").exists() and time.monotonic() < end:
            time.sleep(0.02)
        for path in Path("/proc").glob("[0-9]*"):
            try:
                line = (path / "cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            if str(results).encode() in line and b"optimize" in line:
                os.kill(int(path.name), signal.SIGKILL)

    killer = threading.Thread(target=kill_the_driver)
    killer.start()
    code, _ = submitted(head, deck, *command)
    killer.join()
    assert code != 0
    assert not (results / "result.json").exists()
    code, log = submitted(head, deck, *command)
    assert code == 0, log
    assert digest_of(results) == sound
    code, log = submitted(head, deck, *command)
    assert code == 0
    assert "has ended already" in log


def test_nodes_that_are_lost_and_nodes_that_join(sound: str) -> None:
    """Two nodes beside the head: one is lost in the middle of the run, another one comes."""
    from ray.cluster_utils import Cluster

    cluster = Cluster(
        initialize_head=True,
        head_node_args={
            "num_cpus": 0,
            "_system_config": {
                "health_check_period_ms": 500,
                "health_check_timeout_ms": 500,
                "health_check_failure_threshold": 3,
            },
        },
    )
    try:
        nodes = [cluster.add_node(num_cpus=1) for _ in range(2)]
        ray.init(address=cluster.address, log_to_driver=False, logging_level="error")
        rounds: list[Event] = []

        def lose_one(event: Event) -> None:
            if isinstance(event, RoundReport):
                rounds.append(event)
                if len(rounds) == 2:
                    # in the middle of the next round
                    threading.Timer(0.3, cluster.remove_node, [nodes[0], False]).start()
                if len(rounds) == 3:
                    cluster.add_node(num_cpus=1)

        from islands.executors.ray import RayExecutor
        from islands.run import run

        of = job(plate(), backend="ray")
        executor = RayExecutor()
        try:
            done = run(of, executor, lose_one, 0.0)
        finally:
            executor.close()
        assert len(rounds) > 3
        assert sum(not node["Alive"] for node in ray.nodes()) == 1
        assert done.mesh.digest == finish(job(plate())).mesh.digest == sound
    finally:
        ray.shutdown()
        cluster.shutdown()
