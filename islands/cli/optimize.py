"""Commands of a run: begin it, go on with it, print its settings."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from islands.cli.options import PATH, criteria_option, given_settings, size_option, tell

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from islands.config import Config
    from islands.run import Finished
    from tracking.events import Recorder

INTERRUPTED = 130

_BACKEND = click.option("--backend", type=click.Choice(["local", "ray"]))
_ADDRESS = click.option(
    "--address", metavar="ADDR", help="Of the Ray cluster; default: this machine."
)
_WORKERS = click.option(
    "--workers",
    type=int,
    metavar="N",
    help="Processes of this machine; on a cluster: actors at the most.",
)
_TIME_LIMIT = click.option("--time-limit", type=float, metavar="SECONDS")
_TRACK = click.option("--track", metavar="URI|off", help="MLflow server; default: ./mlflow.db.")
_QUIET = click.option("--quiet", is_flag=True, help="Show no progress.")


@click.command()
@click.argument("mesh", type=PATH)
@click.option("--out", type=PATH, required=True, help="Folder for the results.")
@click.option(
    "--profile", type=click.Choice(["default", "thorough", "paper"]), help="Settings to start from."
)
@click.option(
    "--operation",
    type=click.Choice(["remesh", "replace-node"]),
    help="Run this operation GA alone, as in the paper's section 4.",
)
@click.option("--fitness", type=click.Choice(["trias", "quality"]))
@criteria_option
@size_option
@click.option(
    "--only",
    metavar="SET|PROPERTY|IDS",
    help="Repair this part and lock the rest: a set, a property, or ids like 1:100,205.",
)
@click.option(
    "--regions",
    metavar="ARRAY",
    help="The array of the cells of a .vtu file that tells its parts, whose borders stay.",
)
@click.option(
    "--slide/--no-slide",
    default=None,
    help="Whether nodes on a border may slide along it; default: they may.",
)
@click.option("--islands", type=int, metavar="N")
@click.option("--population", type=int, metavar="N", help="Individuals on each island.")
@click.option("--generations", type=int, metavar="N")
@click.option(
    "--flow",
    type=int,
    metavar="ROUNDS",
    help="Rounds in which rows of quads become longer everywhere, not just where faults are.",
)
@click.option("--seed", type=int, metavar="S")
@_TIME_LIMIT
@_BACKEND
@_ADDRESS
@_WORKERS
@_TRACK
@click.option(
    "--warm-start",
    metavar="DIR",
    help="Begin from the procedure of an earlier run, also of another part.",
)
@click.option("--config", "config_file", type=PATH, metavar="FILE.toml")
@click.option("--overwrite", is_flag=True, help="Write into a folder that is not empty.")
@click.option(
    "--resume",
    "resuming",
    is_flag=True,
    help="Go on with the run in the folder, where one was begun there: for jobs that are retried.",
)
@_QUIET
def optimize(
    mesh: Path,
    out: Path,
    config_file: Path | None,
    *,
    overwrite: bool,
    resuming: bool,
    quiet: bool,
    **options: Any,
) -> None:
    """Evolve a repair procedure for a mesh and write the better mesh."""
    from islands import session
    from islands.config import FILES, FREE, load_config

    _refuse_to_lose(out)
    given = given_settings(options)
    if resuming and session.has_run(out):
        may_differ = {k: v for k, v in given.items() if k.replace("-", "_") in FREE | FILES}
        _go_on(out, may_differ, quiet=quiet, source=mesh)
        return
    config = load_config(config_file, given)
    if resuming:
        session.clear_half_begun(out, config)
    _end(session.optimize(mesh, out, config, _listeners(quiet=quiet), overwrite=overwrite), out)


@click.command()
@click.argument("folder", type=PATH)
@_BACKEND
@_ADDRESS
@_WORKERS
@_TIME_LIMIT
@_TRACK
@_QUIET
def resume(folder: Path, *, quiet: bool, **options: Any) -> None:
    """Go on with a run that was interrupted; it ends with the mesh that it would have had."""
    _go_on(folder, given_settings(options), quiet=quiet)


@click.command()
@click.option("--profile", type=click.Choice(["default", "thorough", "paper"]))
@click.option("--config", "config_file", type=PATH, metavar="FILE.toml")
def config(config_file: Path | None, profile: str | None) -> None:
    """Print all settings in full, as a file for --config."""
    from islands.config import load_config

    given = {} if profile is None else {"profile": profile}
    click.echo(load_config(config_file, given).to_toml(), nl=False)


def _go_on(folder: Path, given: dict[str, Any], *, quiet: bool, source: Path | None = None) -> None:
    from islands import session

    done = session.resume(folder, given, _listeners(quiet=quiet), tell, source)
    if done is None:
        click.echo(f"The run in {folder} has ended already.")
    else:
        _end(done, folder)


def _refuse_to_lose(out: Path) -> None:
    """Refuse a folder that would vanish with the job: a Ray job works in a copy of its folder."""
    import os

    from meshops.errors import InputError

    if "RAY_JOB_CONFIG_JSON_ENV_VAR" in os.environ and not out.is_absolute():
        raise InputError(
            f"--out {out} is relative, and a Ray job works in a copy of its folder that is removed "
            "with it: name an absolute path, on a folder that you can reach."
        )


def _listeners(*, quiet: bool) -> Callable[[Config], Sequence[Recorder]]:
    """Show progress and tell MLflow, as far as that is wanted."""

    def make(config: Config) -> Sequence[Recorder]:
        from tracking.mlflow_recorder import MlflowRecorder
        from tracking.progress import progress

        found: list[Recorder] = [] if quiet else [progress(sys.stdout)]
        if config.track != "off":
            found.append(MlflowRecorder(config.track, notify=tell))
        return found

    return make


def _end(done: Finished, out: Path) -> None:
    from islands.results import closing_words

    click.echo(f"{closing_words(done)} All files are in {out}.")
    if done.worse:
        click.echo(f"Worse than before: {'; '.join(done.worse)}.")
    if done.status != "finished":
        click.echo(f"Go on with: meshipelago resume {out}")
    if done.status == "interrupted":
        sys.exit(INTERRUPTED)
