"""MlflowStore: a run in MLflow. The only file that imports mlflow.

A parent run holds the run as a whole, a child run each island. Everything here waits for the answer
and raises what MLflow raises; ``mlflow_recorder`` decides when to ask and what a failure means.
"""

from __future__ import annotations

import logging
import os
import re
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from tracking.errors import TrackingError
from tracking.events import RunFinished, RunStarted, Status
from tracking.metrics import Point
from tracking.overview import ALL_ISLANDS
from tracking.report import markdown_report

EXPERIMENT = "meshipelago"
BATCH = 1000
"""Metrics in one call: MLflow's own limit."""

_SQLITE = "sqlite:///"
_PARAMETER_LENGTH = 6000
_PARAMETERS_PER_CALL = 100
_RUN_TAG = "meshipelago.run"
_ISLAND_TAG = "meshipelago.island"
_NOTE_TAG = "mlflow.note.content"

# MLflow asks which kind of experiment it opens, unless it is told; this kind has the charts.
_EXPERIMENT_TAGS = {"mlflow.experimentKind": "custom_model_development"}

# Set before mlflow is imported, each only where the user has not: fail in seconds and not in
# minutes, send nothing to anybody, print nothing.
_ENVIRONMENT = {
    "MLFLOW_HTTP_REQUEST_MAX_RETRIES": "1",
    "MLFLOW_HTTP_REQUEST_TIMEOUT": "10",
    "MLFLOW_DISABLE_TELEMETRY": "true",
    "DO_NOT_TRACK": "true",
    "MLFLOW_SUPPRESS_PRINTING_URL_TO_STDOUT": "true",
    "MLFLOW_LOGGING_LEVEL": "ERROR",
}

_STATUS: Mapping[Status, Literal["FINISHED", "KILLED", "FAILED"]] = {
    "finished": "FINISHED",
    "time-limit": "FINISHED",
    "interrupted": "KILLED",
    "failed": "FAILED",
}


def default_store(folder: Path) -> Path:
    """Return where the embedded store of a folder is."""
    return folder / "mlflow.db"


def store_uri(store: Path) -> str:
    """Return the tracking URI of an embedded store."""
    return f"{_SQLITE}{store.absolute()}"


class MlflowStore:
    """One run of meshipelago, as MLflow keeps it.

    Every method may be called again after it has raised, once ``open`` has been: ``open`` looks up
    what of the run is there already, be it from an answer that was lost on its way or from before
    an interruption.
    """

    def __init__(self, uri: str, experiment: str = EXPERIMENT) -> None:
        self.uri = uri
        self._experiment = experiment
        self._experiment_id = ""
        self._client: Any = None
        self._started: RunStarted | None = None
        self._runs: dict[int, str] = {}

    def open(self, started: RunStarted) -> None:
        """Find the run or create it, with its parameters, tags and note."""
        if self._client is None:
            self._client = _client(self.uri)
        self._started = started
        self._experiment_id = _find_or_create_experiment(
            self._client, self._experiment, _artifacts(self.uri)
        )
        found = self._client.search_runs(
            [self._experiment_id],
            f"tags.`{_RUN_TAG}` = '{_run_key(started)}'",
            max_results=50_000,
        )
        self._runs = {int(run.data.tags[_ISLAND_TAG]): run.info.run_id for run in found}
        for run in found:
            if run.info.status != "RUNNING":
                self._client.update_run(run.info.run_id, status="RUNNING")
        parent = self._run(ALL_ISLANDS)
        known = [key for run in found if run.info.run_id == parent for key in run.data.params]
        self._describe(parent, started, known)

    def log(self, points: Sequence[Point]) -> None:
        """Log at most ``BATCH`` points of one island. The same points twice count once."""
        from mlflow.entities import Metric

        if not points:
            return
        metrics = [Metric(p.key, p.value, p.timestamp, p.step) for p in points]
        self._client.log_batch(self._run(points[0].island), metrics=metrics)

    def finish(self, finished: RunFinished | None) -> None:
        """Write down how the run ended; without a ``RunFinished`` it has failed."""
        from mlflow.entities import RunTag

        assert self._started is not None
        if finished is not None:
            tags = {
                _NOTE_TAG: markdown_report(self._started, finished),
                "status": finished.status,
                "reason": finished.reason,
                "digest": finished.digest,
            }
            self._client.log_batch(
                self._run(ALL_ISLANDS), tags=[RunTag(key, value) for key, value in tags.items()]
            )
        status = _STATUS[finished.status if finished else "failed"]
        for run_id in self._runs.values():
            self._client.set_terminated(run_id, status)

    def keep(self, paths: Sequence[Path]) -> None:
        """Log those of the files that exist as artifacts of the parent run."""
        for path in paths:
            if path.is_file():
                self._client.log_artifact(self._run(ALL_ISLANDS), str(path))

    def _run(self, island: int) -> str:
        if island not in self._runs:
            self._runs[island] = self._create_run(island)
        return self._runs[island]

    def _create_run(self, island: int) -> str:
        assert self._started is not None
        tags = {
            _RUN_TAG: _run_key(self._started),
            _ISLAND_TAG: str(island),
            "mlflow.source.name": "meshipelago",
        }
        name = self._started.name
        if island != ALL_ISLANDS:
            tags["mlflow.parentRunId"] = self._run(ALL_ISLANDS)
            name = f"island {island}"
        run = self._client.create_run(self._experiment_id, tags=tags, run_name=name)
        return str(run.info.run_id)

    def _describe(self, run_id: str, started: RunStarted, known: Sequence[str]) -> None:
        """Log what is known at the start; ``known`` parameters stay, for MLflow changes none."""
        from mlflow.entities import Param, RunTag

        tags = {
            "seed": str(started.seed),
            "backend": started.backend,
            _NOTE_TAG: markdown_report(started),
        }
        self._client.log_batch(run_id, tags=[RunTag(key, value) for key, value in tags.items()])
        settings = {
            re.sub(r"[^\w./ :-]", "_", key): str(value)[:_PARAMETER_LENGTH]
            for key, value in started.settings.items()
        }
        parameters = [Param(key, value) for key, value in settings.items() if key not in known]
        for first in range(0, len(parameters), _PARAMETERS_PER_CALL):
            self._client.log_batch(run_id, params=parameters[first : first + _PARAMETERS_PER_CALL])


def find_experiment(store: Path, experiment: str = EXPERIMENT) -> str | None:
    """Return the id of the experiment in an embedded store; None where it has none of that name.

    Raises TrackingError where the file is no store that this version of MLflow reads.
    """
    try:
        found = _client(store_uri(store)).get_experiment_by_name(experiment)
    except Exception as error:  # MLflow lets those of its database library through
        raise TrackingError(f"{store} cannot be read: {first_line(error)}") from error
    return None if found is None else str(found.experiment_id)


def first_line(error: Exception) -> str:
    """Return what MLflow says first; what follows is for its developers."""
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__


def _client(uri: str) -> Any:
    for name, value in _ENVIRONMENT.items():
        os.environ.setdefault(name, value)
    from mlflow import MlflowClient

    logging.getLogger("alembic").setLevel(logging.ERROR)
    if uri.startswith(_SQLITE):
        _create_sqlite(Path(uri.removeprefix(_SQLITE)))
    return MlflowClient(tracking_uri=uri)


def _create_sqlite(store: Path) -> None:
    """Make a fresh store aside and move it into place whole.

    MLflow takes seconds to build its tables in place: a process that is killed meanwhile, or a
    second one that starts, leaves a store that no MLflow opens any more.
    """
    if store.exists():
        return
    from mlflow.store.tracking.sqlalchemy_store import SqlAlchemyStore

    store.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=f".{store.name}.", dir=store.parent) as folder:
        fresh = Path(folder) / store.name
        SqlAlchemyStore(store_uri(fresh), _artifacts(store_uri(store))).engine.dispose()
        try:
            os.link(fresh, store)
        except FileExistsError:
            pass  # another process was faster, its store is as good
        except OSError:  # a file system without hard links
            if not store.exists():
                fresh.rename(store)


def _artifacts(uri: str) -> str | None:
    """Where artifacts go: beside an embedded store; a server decides by itself."""
    if not uri.startswith(_SQLITE):
        return None
    return (Path(uri.removeprefix(_SQLITE)).absolute().parent / "mlartifacts").as_uri()


def _find_or_create_experiment(client: Any, name: str, artifacts: str | None) -> str:
    from mlflow.exceptions import MlflowException

    found = client.get_experiment_by_name(name)
    if found is not None:
        return str(found.experiment_id)
    try:
        return str(
            client.create_experiment(name, artifact_location=artifacts, tags=_EXPERIMENT_TAGS)
        )
    except MlflowException:
        found = client.get_experiment_by_name(name)  # another process was faster
        if found is None:
            raise
        return str(found.experiment_id)


def _run_key(started: RunStarted) -> str:
    """Return the run's id as it can stand in a search."""
    return re.sub(r"[^\w.-]", "-", started.run_id)
