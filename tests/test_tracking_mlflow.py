import os
import signal
import socket
import subprocess
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path

import pytest

from tracking import mlflow_recorder
from tracking.dashboard import charts_link, dashboard_command, serve_dashboard
from tracking.errors import TrackingError
from tracking.events import GenerationReport, MeshSummary, RoundReport, RunFinished, RunStarted
from tracking.mlflow_recorder import MlflowRecorder

ROOT = Path(__file__).parents[1]
BEFORE = MeshSummary(elements=120, quads=109, trias=11, failed=12, compound_qi=3.21)
AFTER = MeshSummary(elements=98, quads=94, trias=4, failed=0, compound_qi=0.5)
START = RunStarted(
    "plate", "run-1", 7, "local", 2, {"ga.size": 10, "long": "x" * 7000, "odd(key)": True}, BEFORE
)
END = RunFinished(
    "finished", "all generations done", AFTER, 96.0, 12.3, 1200, 900, "0 1-2\n2 -", "abc"
)
GENERATIONS = 120  # 840 points an island: more than one batch
POINTS_A_REPORT = 7
POINTS_A_GENERATION = 3  # what it costs, of the run alone
POINTS_OF_ENDS = 22


def report(island, generation):
    best = float(10 * generation + island)
    return GenerationReport(island, generation, best, 5.0, 1.0, best, 8, 4, 1.2, 4, 3, 0.5, "0 1-2")


def record_run(recorder, *, start=START, end=END, generations=GENERATIONS, files=()):
    recorder.record(start)
    for generation in range(generations):
        for island in range(start.islands):
            recorder.record(report(island, generation))
    if end is not None:
        recorder.record(end)
    recorder.keep(files)
    recorder.close()


def main(run_id, status):
    """One process of the two that start on the same fresh store at the same time."""
    sentences = []
    file = Path(f"{run_id}.txt")
    file.write_text("0 1-2\n")
    record_run(
        MlflowRecorder(None, notify=sentences.append),
        start=replace(START, run_id=run_id),
        end=replace(END, status=status) if status != "none" else None,
        files=[file.absolute(), Path("missing.png").absolute()],
    )
    print(*sentences, end="")


@pytest.fixture(scope="module")
def outputs_and_store(tmp_path_factory):
    """The output of two processes at once, and the store that they have made together."""
    folder = tmp_path_factory.mktemp("a folder")
    children = [
        subprocess.Popen(
            [sys.executable, "-c", f"from tests.test_tracking_mlflow import main; main(*{args})"],
            cwd=folder,
            env=os.environ | {"PYTHONPATH": str(ROOT)},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        for args in (("run-1", "interrupted"), ("run-2", "none"))
    ]
    return [child.communicate(timeout=100)[0] for child in children], folder / "mlflow.db"


@pytest.fixture(scope="module")
def client(outputs_and_store):
    from mlflow import MlflowClient

    return MlflowClient(tracking_uri=f"sqlite:///{outputs_and_store[1]}")


@pytest.fixture(scope="module")
def experiment(client):
    return client.get_experiment_by_name("meshipelago")


def family(client, experiment, run_id="run-1"):
    runs = client.search_runs(
        [experiment.experiment_id], f"tags.`meshipelago.run` = '{run_id}'", order_by=["start_time"]
    )
    (parent,) = (run for run in runs if "mlflow.parentRunId" not in run.data.tags)
    children = [
        run for run in runs if run.data.tags.get("mlflow.parentRunId") == parent.info.run_id
    ]
    assert len(runs) == 1 + len(children)
    return parent, sorted(children, key=lambda run: run.info.run_name)


def curve(client, run, key):
    return {m.step: m.value for m in client.get_metric_history(run.info.run_id, key)}


def test_two_processes_may_start_on_a_fresh_store_and_say_nothing(outputs_and_store):
    outputs, store = outputs_and_store
    assert outputs == ["", ""]
    assert {path.name for path in store.parent.iterdir()} == {
        "mlflow.db",
        "mlartifacts",
        "run-1.txt",
        "run-2.txt",
    }


def test_islands_are_children_with_their_metrics_by_generation(client, experiment):
    parent, children = family(client, experiment)
    assert parent.info.run_name == "plate"
    assert [run.info.run_name for run in children] == ["island 0", "island 1"]
    for island, run in enumerate(children):
        expected = {g: 10.0 * g + island for g in range(GENERATIONS)}
        assert curve(client, run, "fitness/best") == expected
        assert curve(client, run, "mesh/failed") == dict.fromkeys(expected, 4.0)
    assert curve(client, parent, "fitness/best_so_far") == {
        g: 10.0 * g + 1 for g in range(GENERATIONS)
    } | {GENERATIONS: END.fitness}
    assert set(curve(client, parent, "cost/evaluations")) == set(range(GENERATIONS + 1))
    assert not any(curve(client, run, "cost/evaluations") for run in children)
    assert curve(client, parent, "before/trias") == {0: 11.0}
    assert curve(client, parent, "after/trias") == {0: 4.0}


def test_parameters_tags_note_and_files_are_on_the_parent(client, experiment, tmp_path):
    parent, _ = family(client, experiment)
    assert parent.data.params == {"ga.size": "10", "long": "x" * 6000, "odd_key_": "True"}
    tags = parent.data.tags
    assert (tags["seed"], tags["backend"], tags["digest"]) == ("7", "local", "abc")
    assert "| failed elements | 12 | 0 |" in tags["mlflow.note.content"]
    assert [f.path for f in client.list_artifacts(parent.info.run_id)] == ["run-1.txt"]
    copy = client.download_artifacts(parent.info.run_id, "run-1.txt", str(tmp_path))
    assert Path(copy).read_text() == "0 1-2\n"


@pytest.mark.parametrize(("run_id", "status"), [("run-1", "KILLED"), ("run-2", "FAILED")])
def test_status_of_parent_and_children(client, experiment, run_id, status):
    parent, children = family(client, experiment, run_id)
    assert [run.info.status for run in (parent, *children)] == [status] * 3


def test_a_resumed_run_goes_on_in_its_record(client, experiment, outputs_and_store):
    sentences = []
    recorder = MlflowRecorder(f"sqlite:///{outputs_and_store[1]}", notify=sentences.append)
    recorder.record(replace(START, run_id="run-2", settings={"ga.size": 20, "more": 1}))
    recorder.record(report(0, GENERATIONS))
    figures = (0, 4, 12, 7, 5, 9, 6, 8, 4200, 2100, 33.3, {"swap-edge": 0.25})
    recorder.record(RoundReport(*figures, number=2, step=3))
    recorder.record(END)
    recorder.close()
    assert sentences == []
    parent, children = family(client, experiment, "run-2")
    assert curve(client, parent, "round/failed") == {3: 9.0}
    assert curve(client, parent, "rate/swap-edge") == {3: 0.25}
    assert [run.info.status for run in (parent, *children)] == ["FINISHED"] * 3
    assert set(curve(client, children[0], "fitness/best")) == set(range(GENERATIONS + 1))
    assert parent.data.params["ga.size"] == "10"
    assert parent.data.params["more"] == "1"


class FlakyStore:
    """Takes what a server that fails on chosen calls would take, and sometimes says it did not."""

    uri = "http://name:password@tracking.example"

    def __init__(self, failures):
        self.failures = set(failures)
        self.calls = 0
        self.points = set()
        self.ended = None
        self.files = None

    def _call(self):
        self.calls += 1
        if self.calls in self.failures:
            raise ConnectionError("no answer")

    def open(self, started):
        self._call()

    def log(self, points):
        assert len(points) <= 1000
        assert len({point.island for point in points}) == 1
        self.points.update(points)
        self._call()

    def finish(self, finished):
        self._call()
        self.ended = finished

    def keep(self, paths):
        self._call()
        self.files = paths


def all_points(generations):
    of_all = POINTS_A_REPORT * (START.islands + 1) + POINTS_A_GENERATION
    return POINTS_OF_ENDS + generations * of_all


@pytest.mark.parametrize("failures", [(), (1,), (2,), (1, 2, 3, 5, 6)])
def test_a_server_that_comes_back_gets_everything(monkeypatch, failures):
    monkeypatch.setattr(mlflow_recorder, "DRAIN_SECONDS", 0.001)
    store, sentences = FlakyStore(failures), []
    recorder = MlflowRecorder(None, notify=sentences.append, store=store)
    recorder.record(START)
    for generation in range(20):
        recorder.record(report(0, generation))
        recorder.record(report(1, generation))
    deadline = time.monotonic() + 10
    while store.calls <= max(failures, default=0) and time.monotonic() < deadline:
        time.sleep(0.001)
    recorder.record(END)
    recorder.keep([Path("result.json")])
    recorder.close()
    assert len(store.points) == all_points(20)
    assert store.ended == END
    assert store.files == (Path("result.json"),)
    assert sentences == [
        "The tracking server at http://tracking.example does not answer: "
        "the run goes on, its record is in the run folder."
    ] * bool(failures)


def test_what_is_missing_at_the_end_is_counted():
    store, sentences = FlakyStore(range(1, 1000)), []
    recorder = MlflowRecorder(None, notify=sentences.append, store=store)
    record_run(recorder, generations=3)
    assert len(sentences) == 2
    assert f" {all_points(3)} points " in sentences[1]


def test_a_run_that_never_began_leaves_no_record():
    store, sentences = FlakyStore([]), []
    MlflowRecorder(None, notify=sentences.append, store=store).close()
    assert (store.calls, sentences) == (0, [])


def test_a_server_that_is_not_there_does_not_hold_the_run_up():
    sentences = []
    start = time.monotonic()
    recorder = MlflowRecorder("http://127.0.0.1:1", notify=sentences.append)
    recorder.record(START)
    recorder.record(report(0, 0))
    assert time.monotonic() - start < 1.0
    recorder.close()
    assert time.monotonic() - start < 30.0
    assert "does not answer" in sentences[0]
    assert "14 points" in sentences[1]
    assert len(sentences) == 2


def test_a_call_that_never_returns_does_not_hold_close_up(monkeypatch):
    monkeypatch.setattr(mlflow_recorder, "CLOSE_SECONDS", 0.1)
    released, sentences = threading.Event(), []
    store = FlakyStore([])
    store.open = lambda started: released.wait(60)
    recorder = MlflowRecorder(None, notify=sentences.append, store=store)
    recorder.record(START)
    start = time.monotonic()
    recorder.close()
    assert time.monotonic() - start < 5.0
    released.set()
    assert len(sentences) == 1
    assert " 7 points " in sentences[0]


def test_dashboard_says_what_is_missing(tmp_path):
    store = tmp_path / "mlflow.db"
    with pytest.raises(TrackingError, match="does not exist"):
        serve_dashboard(5000, store=store)
    store.write_text("not a database, but long enough to be looked at")
    with pytest.raises(TrackingError, match="cannot be read"):
        serve_dashboard(5000, store=store)


def test_dashboard_says_that_a_port_is_taken(outputs_and_store):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(TrackingError, match=f"Port {port}"):
            serve_dashboard(port, store=outputs_and_store[1])


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def await_answer(port, child):
    deadline = time.monotonic() + 90
    while time.monotonic() < deadline and child.poll() is None:
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.2)
    raise AssertionError("the server does not start")


def stop(child):
    if child.poll() is None:
        os.killpg(child.pid, signal.SIGTERM)
    child.wait(30)


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_dashboard_serves_until_it_is_told_to_stop(outputs_and_store, experiment, number):
    port = free_port()
    program = "from tracking.dashboard import serve_dashboard; import sys; "
    program += f"sys.exit(serve_dashboard({port}, announce=lambda s: print(s, flush=True)))"
    child = subprocess.Popen(
        [sys.executable, "-c", program],
        cwd=outputs_and_store[1].parent,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    )
    try:
        lines = iter(child.stdout.readline, "")
        assert charts_link(port, experiment.experiment_id) in map(str.strip, lines)
        child.send_signal(number)
        assert child.wait(60) in (0, 128 + signal.SIGTERM)
        with socket.socket() as probe:
            assert probe.connect_ex(("127.0.0.1", port)) != 0
    finally:
        stop(child)
        child.stdout.close()


@pytest.mark.slow
def test_a_server_that_is_started_again_gets_everything(tmp_path):
    from mlflow import MlflowClient

    port = free_port()
    command = dashboard_command(tmp_path / "mlflow.db", port)
    environment = os.environ | {"MLFLOW_SERVER_ENABLE_JOB_EXECUTION": "false"}

    def serve():
        child = subprocess.Popen(
            command,
            cwd=tmp_path,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        await_answer(port, child)
        return child

    def await_that(condition):
        deadline = time.monotonic() + 90
        while not condition() and time.monotonic() < deadline:
            time.sleep(0.5)
        assert condition()

    uri, sentences = f"http://127.0.0.1:{port}", []
    server = serve()
    try:
        recorder = MlflowRecorder(uri, notify=sentences.append)
        recorder.record(START)
        recorder.record(report(0, 0))
        client = MlflowClient(tracking_uri=uri)
        await_that(lambda: client.get_experiment_by_name("meshipelago") is not None)
        os.killpg(server.pid, signal.SIGKILL)
        server.wait(30)
        for generation in range(1, 50):
            recorder.record(report(0, generation))
        await_that(lambda: len(sentences) == 1)
        server = serve()
        file = tmp_path / "procedure.txt"
        file.write_text("2 -\n")
        recorder.record(END)
        recorder.keep([file])
        time.sleep(10)
        recorder.close()
        assert len(sentences) == 1
        parent, children = family(client, client.get_experiment_by_name("meshipelago"))
        assert set(curve(client, children[0], "fitness/best")) == set(range(50))
        assert [run.info.status for run in (parent, *children)] == ["FINISHED"] * 2
        assert [f.path for f in client.list_artifacts(parent.info.run_id)] == ["procedure.txt"]
    finally:
        stop(server)
