"""Session: a run in its folder, from the deck to all its files, and what goes on from there.

The folder says what the run is (``config.toml``, ``run.json``), how far it is (the checkpoint) and
what it has seen (the journal).
"""

from __future__ import annotations

import errno
import json
import time
import tomllib
import uuid
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from islands.checkpoint import CHECKPOINT, Checkpoints, latest_state
from islands.chronicle import Chronicle
from islands.config import Config, load_config
from islands.folder import CONFIG, CRITERIA, RESULT, RUN, SIZES, about_run, status_of
from islands.interruption import Interruption
from islands.results import prepare_folder, write_results, write_text
from islands.run import Finished, Job, run, start_executor
from islands.search import SearchState, State
from meshops.criteria import BUILT_IN
from meshops.criteria_files import dump_criteria, load_criteria
from meshops.errors import InputError
from meshops.formats import Deck, read_deck
from meshops.formats.locks import locks_told, only_lock
from meshops.formats.selection import locked_but
from meshops.quality import median_edge
from meshops.sizing import samples_text
from tracking.events import Event, GenerationReport, Recorder, RoundReport
from tracking.fanout import Fanout
from tracking.journal import Journal, read_journal

_NO_ROOM = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}

Listeners = Callable[[Config], Sequence[Recorder]]
"""Makes those that follow a run besides its journal."""


@dataclass(frozen=True, eq=False)
class _Run:
    """A deck that is to be improved, in a folder.

    Attributes
    ----------
    folder, source : Path
    deck : Deck
    job : Job
    run_id : str
    state : SearchState, Milestone or None
        What an earlier session has left.
    """

    folder: Path
    source: Path
    deck: Deck
    job: Job
    run_id: str
    state: State | None = None


def optimize(
    source: Path, folder: Path, config: Config, listeners: Listeners, *, overwrite: bool
) -> Finished:
    """Improve a deck; all files of the run are in the folder then.

    Raises InputError, before anything is written, where the deck, the folder or a setting is not
    what it should be.
    """
    started = time.monotonic()
    deck, job = _read(source, config)
    deck.check_room()
    this = _Run(folder, source, deck, job, uuid.uuid4().hex)

    def begin() -> Sequence[Event]:
        prepare_folder(folder, source, overwrite=overwrite)
        (folder / RESULT).unlink(missing_ok=True)
        about = {
            "source": str(source.resolve()),
            "mesh": job.mesh.digest,
            "surface": job.mesh.surface_digest,
            "run": this.run_id,
        }
        write_text(folder / CRITERIA, _criteria_text(config))
        write_text(folder / CONFIG, _settings_text(job.config))
        if job.assessment.sizes is not None:
            write_text(folder / SIZES, samples_text(job.assessment.sizes, job.mesh))
        write_text(folder / RUN, json.dumps(about, indent=1) + "\n")
        return ()

    return _work(this, started, begin, listeners)


def has_run(folder: Path) -> bool:
    """Whether a run was begun in a folder."""
    return (folder / RUN).exists()


def clear_half_begun(folder: Path, config: Config) -> None:
    """Empty a folder in which this very run was killed as soon as it had written its settings."""
    files = list(folder.iterdir()) if folder.is_dir() else []
    if {file.name for file in files} <= {CONFIG, CRITERIA, SIZES} and _are_ours(folder, config):
        for file in files:
            file.unlink()


def _are_ours(folder: Path, config: Config) -> bool:
    """Whether all settings in a folder are those that this run writes."""
    settings, criteria = folder / CONFIG, folder / CRITERIA
    if criteria.exists() and criteria.read_text(encoding="utf-8") != _criteria_text(config):
        return False
    if not settings.exists():
        return not (folder / SIZES).exists()
    try:
        found = tomllib.loads(settings.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError):
        return False
    mine = tomllib.loads(_settings_text(config))
    return found | {"judged-size": None} == mine | {"judged-size": None}


def _criteria_text(config: Config) -> str:
    return dump_criteria(load_criteria(config.criteria))


def _settings_text(config: Config) -> str:
    """All settings; criteria of a file are those beside it."""
    return config.to_toml(**({} if config.criteria in BUILT_IN else {"criteria": CRITERIA}))


def resume(
    folder: Path,
    given: Mapping[str, Any],
    listeners: Listeners,
    notify: Callable[[str], None],
    source: Path | None = None,
) -> Finished | None:
    """Go on with a run from its checkpoint; None where it has ended already.

    `given` are settings that may be others than before: `FREE`, and where `FILES` are. The mesh at
    the end is that of the run without the interruption. `notify` is told of what was damaged.
    `source` is where the deck is now; None: where it was.

    Raises InputError where the folder has no run that can go on.
    """
    started = time.monotonic()
    about = about_run(folder)
    if status_of(folder) == "finished" and not (folder / CHECKPOINT).exists():
        return None
    # the time limit was that of the session before
    config = load_config(folder / CONFIG, {"time-limit": None, **given})
    source = source or Path(about["source"])
    deck, job = _read(source, config)
    if job.mesh.digest != about["mesh"]:
        raise InputError(f"{source} is another mesh than that of the run in {folder}.")
    state, sentence = latest_state(folder, job.key)
    if sentence:
        notify(f"{sentence} The run goes on from the checkpoint before it.")

    def begin() -> Sequence[Event]:
        return _events_until(folder, state)

    return _work(_Run(folder, source, deck, job, about["run"], state), started, begin, listeners)


def _work(
    this: _Run, started: float, begin: Callable[[], Sequence[Event]], listeners: Listeners
) -> Finished:
    """Run a job with everything around it.

    `begin` makes the folder ready, once the backend has answered, and says what has happened.
    """
    job, config, state = this.job, this.job.config, this.state
    interruption = Interruption()
    executor = start_executor(job, started + (config.time_limit or float("inf")), interruption.heed)
    try:
        known = begin()
        reports = (e for e in known if isinstance(e, RoundReport | GenerationReport))
        spent = max((report.seconds for report in reports), default=0.0)
        checkpoints = Checkpoints(this.folder, job.key, state)
        recorder = Fanout([Journal(this.folder, known), *listeners(config)])

        chronicle = Chronicle(known)

        def record(event: Event) -> None:
            recorder.record(chronicle.told(event))
            if isinstance(event, GenerationReport):
                interruption.heed()

        with ExitStack() as ending:
            ending.callback(recorder.close)
            ending.callback(checkpoints.close)
            with interruption:  # after Ray has set its own signals
                done = run(
                    job, executor, record, started - spent,
                    keep=checkpoints.keep, state=state, run_id=this.run_id,
                )  # fmt: skip
                files = write_results(this.folder, job, this.deck, this.source, done)
                recorder.keep(files)
        if done.status == "finished":
            checkpoints.discard()
    except (OSError, InputError) as error:
        cause = error if isinstance(error, OSError) else error.__cause__
        if not isinstance(cause, OSError) or cause.errno not in _NO_ROOM:
            raise
        raise InputError(
            f"{this.folder}: {cause.strerror}. All that was written until then is there; make room "
            f"and go on with meshipelago resume {this.folder}."
        ) from None
    finally:
        executor.close()
    return done


def _read(source: Path, config: Config) -> tuple[Deck, Job]:
    deck = read_deck(source, regions=config.regions)
    mesh, locks = deck.mesh, deck.locks
    if config.only is not None:
        mesh = locked_but(mesh, deck.select(config.only))
        locks = (only_lock(deck.mesh, mesh, config.only), *locks)
    if config.element_size is None and config.judged_size is None:
        config = config.model_copy(update={"judged_size": median_edge(mesh)})
    told = (*locks_told(mesh, locks), *deck.notes)
    return deck, Job.of(source.name, mesh, load_criteria(config.criteria), config, locks, told)


def _events_until(folder: Path, state: State | None) -> list[Event]:
    """Events of a journal until a state was reached; those after it will happen again."""
    if state is None:
        return []
    events = read_journal(folder)
    if not isinstance(state, SearchState):
        later = (
            number
            for number, event in enumerate(events)
            if isinstance(event, GenerationReport) and event.generation >= state.generation
        )
        return events[: next(later, len(events))]
    kept = rounds = 0
    reports = state.reports
    for number, event in enumerate(events):
        if rounds == reports:
            break
        rounds += isinstance(event, RoundReport)
        kept = number + 1
    return events[:kept]
