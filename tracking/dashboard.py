"""The dashboard: MLflow's pages over the embedded store, in the foreground."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import FrameType

from tracking.errors import TrackingError
from tracking.mlflow_store import default_store, find_experiment, store_uri

_HOST = "127.0.0.1"

# The job runner would start a dozen processes more, for nothing that is used here.
_ENVIRONMENT = {
    "MLFLOW_SERVER_ENABLE_JOB_EXECUTION": "false",
    "MLFLOW_DISABLE_TELEMETRY": "true",
    "DO_NOT_TRACK": "true",
}


def dashboard_command(store: Path, port: int) -> list[str]:
    """Return the command that serves a store's pages on this machine only."""
    command = [sys.executable, "-m", "mlflow", "server", "--backend-store-uri", store_uri(store)]
    return [*command, "--workers", "1", "--host", _HOST, "--port", str(port)]


def charts_link(port: int, experiment_id: str) -> str:
    """Return the address of the charts; the bare address opens on a table."""
    query = "workflowType=machine_learning&compareRunsMode=CHART"
    return f"http://{_HOST}:{port}/#/experiments/{experiment_id}/runs?{query}"


def serve_dashboard(
    port: int, *, store: Path | None = None, announce: Callable[[str], None] = print
) -> int:
    """Serve the pages until Ctrl-C, SIGTERM or a closed terminal; return the server's exit code.

    ``announce`` gets the address of the charts as soon as it answers. Call this from the main
    thread: it handles signals.

    Raises
    ------
    TrackingError
        Where there is no store, nothing in it, or the port is taken.
    """
    store = store or default_store(Path.cwd())
    if not store.is_file():
        raise TrackingError(
            f"{store} does not exist: run meshipelago in this folder first, or go to the folder "
            "where it was run."
        )
    experiment_id = find_experiment(store)
    if experiment_id is None:
        raise TrackingError(f"{store} holds no run of meshipelago: name another store.")
    if _answers(port):
        raise TrackingError(f"Port {port} is taken: choose another one.")
    # In a session of its own the server gets its signals from here alone, with its workers.
    child = subprocess.Popen(
        dashboard_command(store, port), env=os.environ | _ENVIRONMENT, start_new_session=True
    )
    kinds = iter([signal.SIGTERM])

    def stop(number: int, frame: FrameType | None) -> None:
        if child.poll() is None:
            os.killpg(child.pid, next(kinds, signal.SIGKILL))  # the second time for good

    stopping = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = {number: signal.signal(number, stop) for number in stopping}
    try:
        while child.poll() is None and not _answers(port):
            time.sleep(0.2)
        if child.poll() is None:
            announce(charts_link(port, experiment_id))
        code = child.wait()
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    return code if code >= 0 else 128 - code


def _answers(port: int) -> bool:
    with socket.socket() as probe:
        probe.settimeout(1.0)
        return probe.connect_ex((_HOST, port)) == 0
