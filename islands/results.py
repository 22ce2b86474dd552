"""Results: the files that a run leaves in its folder."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from islands.assessing import verifier
from islands.folder import RESULT
from islands.run import Finished, Job, summary
from meshops.errors import InputError
from meshops.failures import TRIED, csv_text, failures
from meshops.formats import Deck, check_writable_suffix, read_deck, write_mesh
from meshops.formats.verified import nothing_else, write_verified
from meshops.mesh import ShellMesh
from meshops.operations import ALL_OPERATIONS
from meshops.pictures import draw
from tracking.journal import HISTORY

FAILED = "failed.csv"

CUT_SHORT = "tried in vain, or not reached before the run was cut short"
"""Why an element stays that nothing holds, where a run has not come to its end."""


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
    check_writable_suffix(folder / source.name)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder} cannot be made: {error.strerror}.") from None


def write_results(folder: Path, job: Job, deck: Deck, source: Path, done: Finished) -> list[Path]:
    """Write all files of a finished run; each whole, under its name when it is complete.

    Returns the files, the ones for the dashboard.
    """
    assessment = job.assessment
    before = job.mesh
    read = partial(read_deck, regions=job.config.regions)
    check = verifier(assessment) if job.config.profile != "paper" else nothing_else
    after = write_verified(deck, done.mesh, folder / source.name, check, read).mesh
    write_mesh(
        after,
        folder / "mesh.vtu",
        cell_data={
            "element Q.I.": assessment.element_index(after),
            "element id": after.element_ids,
        },
    )
    failed = failures(
        after,
        assessment,
        locks=job.locks,
        feature_angle=job.config.feature_angle,
        otherwise=TRIED if done.status == "finished" else CUT_SHORT,
    )
    texts = {
        "procedure.json": done.procedure.to_json(ALL_OPERATIONS),
        "procedure.txt": done.text + "\n",
        "quality_before.txt": _report_text(job, before),
        "quality_after.txt": _report_text(job, after),
        FAILED: csv_text(failed),
        RESULT: json.dumps(result_document(job, done), indent=1) + "\n",
    }
    draw(before, assessment, folder / "before.png", title=f"{job.name} before")
    draw(after, assessment, folder / "after.png", title=f"{job.name} after")
    for name, text in texts.items():  # the last one says that all are there
        write_text(folder / name, text)
    others = ("before.png", "after.png", HISTORY)  # the journal makes the history when it closes
    return [folder / name for name in (*texts, *others)]


def closing_words(done: Finished) -> str:
    """Say what a run has brought, in one sentence."""
    before, after = done.before, done.after
    return (
        f"{before.failed} failed elements -> {after.failed} "
        f"(by shape {before.failed_by_shape} -> {after.failed_by_shape}, "
        f"by size alone {before.failed_by_size} -> {after.failed_by_size}), "
        f"{before.trias} trias -> {after.trias}, compound Q.I. {before.compound_qi:.2f} -> "
        f"{after.compound_qi:.2f}, {done.irregular_before} irregular nodes -> "
        f"{done.irregular_after}; {_smallness(done)}{done.seconds:.1f} s.{_left(done)}"
    )


def _smallness(done: Finished) -> str:
    if not done.changed_elements:
        return "nothing changed; "
    each = done.changed_per_fault
    share = "" if each is None else f", {each:.1f} elements for each fault that went"
    return f"{done.changed_elements} elements and {done.changed_nodes} nodes changed{share}; "


def _left(done: Finished) -> str:
    words = done.left_in_rows.words()
    return f" {words}, or another size (--size)." if words else ""


def result_document(job: Job, done: Finished) -> Mapping[str, Any]:
    """Make what result.json holds."""
    return {
        "seed": job.config.seed,
        "backend": job.config.backend,
        "status": done.status,
        "judged_by": job.assessment.document(),
        "seconds": round(done.seconds, 3),
        "evaluations": done.evaluations,
        "performed": done.performed,
        "before": asdict(summary(done.before)),
        "after": asdict(summary(done.after)),
        "irregular_nodes": {"before": done.irregular_before, "after": done.irregular_after},
        "changed": {
            "elements": done.changed_elements,
            "nodes": done.changed_nodes,
            "elements_per_fault": done.changed_per_fault,
        },
        "left_in_regular_rows": asdict(done.left_in_rows),
        "worse": list(done.worse),
        "fitness": done.fitness,
        "procedure": done.text,
        "digest": done.mesh.digest,
    }


def _report_text(job: Job, mesh: ShellMesh) -> str:
    return f"{job.assessment.text()}\n\n{job.quality(mesh).table()}"


def write_text(path: Path, text: str) -> None:
    """Write a file whole: under another name first, then renamed."""
    partial = path.with_name(f".{path.name}.part")
    partial.write_text(text, encoding="utf-8")
    partial.replace(path)
