"""Results: the files that a run leaves in its folder."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from islands.run import Finished, Job, summary
from meshops.errors import InputError
from meshops.formats import Deck, write_mesh
from meshops.operations import ALL_OPERATIONS
from meshops.pictures import draw
from meshops.quality import element_index
from tracking.journal import HISTORY

RESULT = "result.json"


def prepare_folder(folder: Path, source: Path, *, overwrite: bool) -> None:
    """Make the run folder.

    Raises InputError where it is in use and may not be overwritten, and where the user's deck is
    in it.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file; name another folder with --out.")
    if folder.is_dir() and any(folder.iterdir()) and not overwrite:
        raise InputError(
            f"{folder} is not empty; name another folder with --out, or say --overwrite."
        )
    if (folder / source.name).resolve() == source.resolve():
        raise InputError(f"{source} lies in {folder}; name another folder with --out.")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder} cannot be made: {error.strerror}.") from None


def write_results(folder: Path, job: Job, deck: Deck, source: Path, done: Finished) -> list[Path]:
    """Write all files of a finished run; each whole, under its name when it is complete.

    Returns the files, the ones for the dashboard.
    """
    scoring = job.problem.setting.scoring
    deck.write(done.mesh, folder / source.name)
    write_mesh(
        done.mesh,
        folder / "mesh.vtu",
        cell_data={"element Q.I.": element_index(done.mesh, scoring)},
    )
    texts = {
        "procedure.json": done.procedure.to_json(ALL_OPERATIONS),
        "procedure.txt": done.text + "\n",
        "quality_before.txt": done.before.table() + "\n",
        "quality_after.txt": done.after.table() + "\n",
        RESULT: json.dumps(result_document(job, done), indent=1) + "\n",
    }
    draw(job.mesh, scoring, folder / "before.png", title=f"{job.name} before")
    draw(done.mesh, scoring, folder / "after.png", title=f"{job.name} after")
    for name, text in texts.items():  # the last one says that all are there
        write_text(folder / name, text)
    others = ("before.png", "after.png", HISTORY)  # the journal makes the history when it closes
    return [folder / name for name in (*texts, *others)]


def result_document(job: Job, done: Finished) -> Mapping[str, Any]:
    """Make what result.json holds."""
    return {
        "seed": job.config.seed,
        "backend": job.config.backend,
        "status": done.status,
        "seconds": round(done.seconds, 3),
        "evaluations": done.evaluations,
        "performed": done.performed,
        "before": asdict(summary(done.before)),
        "after": asdict(summary(done.after)),
        "irregular_nodes": {"before": done.irregular_before, "after": done.irregular_after},
        "fitness": done.fitness,
        "procedure": done.text,
        "digest": done.mesh.digest,
    }


def write_text(path: Path, text: str) -> None:
    """Write a file whole: under another name first, then renamed."""
    partial = path.with_name(f".{path.name}.part")
    partial.write_text(text, encoding="utf-8")
    partial.replace(path)
