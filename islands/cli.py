"""The command line. Heavy imports wait inside the commands, so that --help answers at once."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from islands.config import Config
    from islands.run import Finished
    from tracking.events import Recorder

DONE, BAD_INPUT, INTERRUPTED = 0, 2, 130

FLOW_OF_NEW_MESHES = 3
"""Rounds for a better flow of what `mesh` makes: there is no mesh yet that is to be kept."""

_PATH = click.Path(path_type=Path)
_CRITERIA = click.option(
    "--criteria",
    metavar="FILE|paper|standard",
    help="What counts as a good element: a built-in set, TOML, or HyperMesh's .criteria text.",
)
_SIZE = click.option(
    "--size", type=float, metavar="L", help="Target element size; default: the median edge."
)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="meshipelago")
def cli() -> None:
    """Repair shell meshes by evolving the repair procedure."""


def main() -> None:
    """Run a command; bad input ends with one sentence and exit code 2."""
    from meshops.errors import InputError
    from tracking.errors import TrackingError

    try:
        cli.main(standalone_mode=False)
    except click.exceptions.Exit as stop:
        sys.exit(stop.exit_code)
    except click.ClickException as error:
        error.show()
        sys.exit(BAD_INPUT)
    except (click.Abort, KeyboardInterrupt):
        click.echo("Interrupted.", err=True)
        sys.exit(INTERRUPTED)
    except (InputError, TrackingError) as error:
        click.echo(f"meshipelago: {error}", err=True)
        sys.exit(BAD_INPUT)
    except OSError as error:
        click.echo(f"meshipelago: {error.filename}: {error.strerror}.", err=True)
        sys.exit(BAD_INPUT)


@cli.command()
@click.argument("name", type=click.Choice(["plate"]))
@click.option("--out", type=_PATH, required=True, help="The deck to write.")
def example(name: str, out: Path) -> None:
    """Write an example mesh; `plate` is the test piece of the paper."""
    from meshops.examples import EXAMPLES
    from meshops.formats import write_mesh

    _refuse_to_overwrite(out)
    write_mesh(EXAMPLES[name](), out)


@cli.command()
@click.argument("mesh", type=_PATH)
@_CRITERIA
@_SIZE
@click.option("--json", "json_file", type=_PATH, help="Also write the report as JSON.")
def check(mesh: Path, criteria: str | None, size: float | None, json_file: Path | None) -> None:
    """Print the QualityIndex of a mesh."""
    import json

    from islands.results import write_text
    from meshops.criteria_files import load_criteria
    from meshops.formats import read_deck
    from meshops.quality import median_edge
    from meshops.quality_index import quality_index

    shells = read_deck(mesh).mesh
    scoring = load_criteria(criteria or "standard").at(_positive(size) or median_edge(shells))
    report = quality_index(shells, scoring)
    click.echo(report.table())
    if json_file:
        write_text(json_file, json.dumps(report.to_json(), indent=1) + "\n")


@cli.command()
@click.argument("mesh", type=_PATH)
@click.option("--out", type=_PATH, required=True, help="Folder for the results.")
@click.option(
    "--profile", type=click.Choice(["default", "thorough", "paper"]), help="Settings to start from."
)
@click.option(
    "--operation",
    type=click.Choice(["remesh", "replace-node"]),
    help="Run this operation GA alone, as in the paper's section 4.",
)
@click.option("--fitness", type=click.Choice(["trias", "quality"]))
@_CRITERIA
@click.option(
    "--size",
    metavar="L|local|FILE",
    help="Target element size: a number, the mesh's own gradation, or a file of x,y,z,size.",
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
@click.option("--time-limit", type=float, metavar="SECONDS")
@click.option("--backend", type=click.Choice(["local", "ray"]))
@click.option("--address", metavar="ADDR", help="Of the Ray cluster; default: this machine.")
@click.option(
    "--workers",
    type=int,
    metavar="N",
    help="Processes of this machine; on a cluster: actors at the most.",
)
@click.option("--track", metavar="URI|off", help="MLflow server; default: ./mlflow.db.")
@click.option(
    "--warm-start",
    metavar="DIR",
    help="Begin from the procedure of an earlier run, also of another part.",
)
@click.option("--config", "config_file", type=_PATH, metavar="FILE.toml")
@click.option("--overwrite", is_flag=True, help="Write into a folder that is not empty.")
@click.option(
    "--resume",
    "resuming",
    is_flag=True,
    help="Go on with the run in the folder, where one was begun there: for jobs that are retried.",
)
@click.option("--quiet", is_flag=True, help="Show no progress.")
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
    given = {name.replace("_", "-"): v for name, v in options.items() if v is not None}
    if "size" in given:
        given["size"] = _number_or_name(given["size"])
    if resuming and session.has_run(out):
        may_differ = {k: v for k, v in given.items() if k.replace("-", "_") in FREE | FILES}
        _go_on(out, may_differ, quiet=quiet, source=mesh)
        return
    config = load_config(config_file, given)
    if resuming:
        session.clear_half_begun(out, config)
    _end(session.optimize(mesh, out, config, _listeners(quiet=quiet), overwrite=overwrite), out)


@cli.command()
@click.argument("folder", type=_PATH)
@click.option("--backend", type=click.Choice(["local", "ray"]))
@click.option("--address", metavar="ADDR", help="Of the Ray cluster; default: this machine.")
@click.option(
    "--workers",
    type=int,
    metavar="N",
    help="Processes of this machine; on a cluster: actors at the most.",
)
@click.option("--time-limit", type=float, metavar="SECONDS")
@click.option("--track", metavar="URI|off", help="MLflow server; default: ./mlflow.db.")
@click.option("--quiet", is_flag=True, help="Show no progress.")
def resume(folder: Path, *, quiet: bool, **options: Any) -> None:
    """Go on with a run that was interrupted; it ends with the mesh that it would have had."""
    given = {name.replace("_", "-"): v for name, v in options.items() if v is not None}
    _go_on(folder, given, quiet=quiet)


@cli.command()
@click.option("--profile", type=click.Choice(["default", "thorough", "paper"]))
@click.option("--config", "config_file", type=_PATH, metavar="FILE.toml")
def config(config_file: Path | None, profile: str | None) -> None:
    """Print all settings in full, as a file for --config."""
    from islands.config import load_config

    given = {} if profile is None else {"profile": profile}
    click.echo(load_config(config_file, given).to_toml(), nl=False)


@cli.command()
@click.argument("procedure", type=_PATH)
@click.argument("mesh", type=_PATH)
@click.option("--out", type=_PATH, required=True, help="The mesh to write.")
def replay(procedure: Path, mesh: Path, out: Path) -> None:
    """Perform a procedure again, bit for bit on its own mesh, or try it on another one."""
    from islands.replay import replay_file
    from meshops.formats import check_writable_suffix

    check_writable_suffix(out)
    _refuse_to_overwrite(out)
    click.echo(replay_file(procedure, mesh, out))


@cli.command()
@click.argument("part", type=_PATH)
@click.option("--out", type=_PATH, required=True, help="The mesh to write.")
@_CRITERIA
@_SIZE
@click.option("--seed", type=int, metavar="S")
@click.option("--time-limit", type=float, metavar="SECONDS")
def mesh(part: Path, out: Path, **options: Any) -> None:
    """Mesh a part (.stl; with the extra "cad" .step and .iges too), then repair the mesh."""
    from islands.config import load_config
    from islands.run import Job, improve
    from meshops.criteria_files import load_criteria
    from meshops.formats import check_writable_suffix, write_mesh
    from meshops.geometry import default_size, mesh_geometry

    check_writable_suffix(out)
    _refuse_to_overwrite(out)
    given = {name.replace("_", "-"): v for name, v in options.items() if v is not None}
    _positive(given.get("size"))
    shells = mesh_geometry(part, given.get("size"))
    given.setdefault("size", default_size(shells.points))
    given.setdefault("flow", FLOW_OF_NEW_MESHES)
    config = load_config(None, given)
    job = Job.of(part.name, shells, load_criteria(config.criteria), config)
    done = improve(job)
    write_mesh(done.mesh, out)
    click.echo(f"{out}: {len(done.mesh.elements)} elements; {_closing_words(done)}")


@cli.command()
@click.argument("mesh", type=_PATH)
@click.option("--out", type=_PATH, required=True, help="The PNG to write.")
@_CRITERIA
@_SIZE
def picture(mesh: Path, out: Path, criteria: str | None, size: float | None) -> None:
    """Draw a mesh, with its trias and failed elements in colour."""
    from meshops.criteria_files import load_criteria
    from meshops.formats import read_deck
    from meshops.pictures import draw
    from meshops.quality import median_edge

    _refuse_to_overwrite(out)
    shells = read_deck(mesh).mesh
    scoring = load_criteria(criteria or "standard").at(_positive(size) or median_edge(shells))
    draw(shells, scoring, out, title=mesh.name)


@cli.command()
@click.option("--port", type=click.IntRange(1, 65535), default=5000, show_default=True)
def dashboard(port: int) -> None:
    """Show the MLflow pages of the store in this folder, until Ctrl-C."""
    from tracking.dashboard import serve_dashboard

    sys.exit(serve_dashboard(port, announce=click.echo))


def _go_on(folder: Path, given: dict[str, Any], *, quiet: bool, source: Path | None = None) -> None:
    from islands import session

    done = session.resume(folder, given, _listeners(quiet=quiet), _tell, source)
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
            found.append(MlflowRecorder(config.track, notify=_tell))
        return found

    return make


def _end(done: Finished, out: Path) -> None:
    click.echo(f"{_closing_words(done)} All files are in {out}.")
    if done.status != "finished":
        click.echo(f"Go on with: meshipelago resume {out}")
    if done.status == "interrupted":
        sys.exit(INTERRUPTED)


def _tell(sentence: str) -> None:
    click.echo(sentence, err=True)


def _closing_words(done: Finished) -> str:
    before, after = done.before, done.after
    return (
        f"{before.failed} failed elements -> {after.failed}, "
        f"{before.trias} trias -> {after.trias}, compound Q.I. {before.compound_qi:.2f} -> "
        f"{after.compound_qi:.2f}, {done.irregular_before} irregular nodes -> "
        f"{done.irregular_after}; {done.seconds:.1f} s."
    )


def _number_or_name(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _positive(size: float | None) -> float | None:
    if size is not None and not 0 < size < float("inf"):
        raise click.UsageError(f"--size is {size}: it must be above 0.")
    return size


def _refuse_to_overwrite(path: Path) -> None:
    from meshops.errors import InputError

    if path.exists():
        raise InputError(f"{path} is there already; name another file with --out.")
