"""Checking: what a check looks at, by what it judges, and what it leaves behind."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from islands.assessing import Size, assessment_of
from islands.config import load_config
from islands.folder import (
    CONFIG,
    assessment_of_run,
    deck_name,
    is_written_deck,
    written_deck,
)
from meshops.assessment import Assessment
from meshops.criteria_files import load_criteria
from meshops.errors import InputError
from meshops.failures import Failure, failures
from meshops.formats import KNOWN, Deck, read_deck
from meshops.formats.locks import locks_told
from meshops.quality_index import QualityIndex
from meshops.sizing import LOCAL, SizeSamples
from meshops.topology import FEATURE_ANGLE

_ELSEWHERE = 0.05
"""Of the extent of a part: what reaches farther beyond it is another part."""

KIND = "meshipelago check"
"""What a JSON report says that it is."""


@dataclass(frozen=True, eq=False)
class Subject:
    """A deck that is to be judged.

    Attributes
    ----------
    path : Path
    deck : Deck
    assessment : Assessment
    run : Path or None
        The run by which it is judged.
    feature_angle : float
    """

    path: Path
    deck: Deck
    assessment: Assessment
    run: Path | None
    feature_angle: float

    @property
    def told(self) -> tuple[str, ...]:
        """By what it is judged, and what of it is locked, a line each."""
        by_run = f" (as the run in {self.run})" if self.run else ""
        return (
            f"{self.path}: {self.assessment.text()}{by_run}",
            *locks_told(self.deck.mesh, self.deck.locks),
            *self.deck.notes,
        )

    def failures(self) -> tuple[Failure, ...]:
        """All elements that fail, and what holds them."""
        return failures(
            self.deck.mesh,
            self.assessment,
            locks=self.deck.locks,
            feature_angle=self.feature_angle,
            otherwise="nothing holds it",
        )


def subject_of(
    path: Path, *, criteria: str | None = None, size: Size = None, like: Path | None = None
) -> Subject:
    """Read what is to be judged: a deck, or of the folder of a run the deck that it wrote.

    It is judged by the run `like`, or else by the run in whose folder it is, or else as `optimize`
    would by its default; criteria and size that are given come before that.

    Raises InputError where there is no deck, or a setting is not what it should be.
    """
    run = like
    if path.is_dir():
        run, path = like or path, written_deck(path)
    elif run is None and is_written_deck(path):
        run = path.parent
    deck = read_deck(path)
    if run is None or (criteria is not None and size is not None):
        chosen = load_criteria(criteria or "standard")
        return Subject(path, deck, assessment_of(deck.mesh, chosen, size), None, FEATURE_ANGLE)
    assessment = assessment_of_run(run)
    if path.resolve() != (run / deck_name(run)).resolve():
        assessment = _for_another(assessment, deck)
    if criteria is not None:
        scoring = load_criteria(criteria).at(assessment.scoring.size)
        assessment = replace(assessment, scoring=scoring)
    if size is not None:
        assessment = assessment_of(
            deck.mesh, assessment.criteria, size, reference=assessment.reference
        )
    angle = load_config(run / CONFIG, {}).feature_angle
    return Subject(path, deck, assessment, run, angle)


def _for_another(assessment: Assessment, deck: Deck) -> Assessment:
    """Judge another deck than that of the run: its surface is its own.

    So is its gradation, where it is another part, which lies elsewhere than the run's sizes.
    """
    mesh, sizes = deck.mesh, assessment.sizes
    if isinstance(sizes, SizeSamples) and assessment.gradation == LOCAL:
        margin = _ELSEWHERE * np.linalg.norm(np.ptp(sizes.places, axis=0))
        low, high = sizes.places.min(axis=0) - margin, sizes.places.max(axis=0) + margin
        if not ((mesh.points >= low) & (mesh.points <= high)).all():
            sizes = SizeSamples.of(mesh)
    return replace(assessment, sizes=sizes, reference=None)


def json_text(subject: Subject, report: QualityIndex, listed: Sequence[Failure] | None) -> str:
    """Write a report as JSON; with every failing element where they are listed."""
    document: dict[str, Any] = {
        "kind": KIND,
        "deck": str(subject.path),
        "judged_by": subject.assessment.document(),
        "locked": list(subject.told[1:]),
        **report.to_json(),
    }
    if listed is not None:
        document["failures"] = [asdict(failure) for failure in listed]
    return json.dumps(_finite(document), indent=1) + "\n"


def prepare_report(target: Path, sources: Sequence[Path], *, overwrite: bool) -> None:
    """Refuse to write a report where that would cost the user a file.

    Raises InputError where `target` is one of the files of the deck or another deck, and where it
    is there, is no such report and may not be overwritten.
    """
    if target.is_dir() or not target.absolute().parent.is_dir():
        raise InputError(f"--json {target}: there is no such file, nor a folder to make it in.")
    is_deck = target.suffix.lower() in KNOWN or target.resolve() in {s.resolve() for s in sources}
    if is_deck:
        raise InputError(f"--json {target} would be written over a deck: name another file.")
    if target.exists() and not overwrite and not _is_report(target):
        raise InputError(
            f"{target} is there and is no report of a check: name another file with --json, or say "
            "--overwrite."
        )


def _is_report(path: Path) -> bool:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(document, dict) and document.get("kind") == KIND


def _finite(value: Any) -> Any:
    """Replace numbers that JSON does not know by None."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
