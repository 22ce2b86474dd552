"""Folder: what the folder of a run says about it."""

from __future__ import annotations

import json
from pathlib import Path

from islands.assessing import gradation_name
from islands.config import load_config
from meshops.assessment import EVEN, Assessment
from meshops.criteria_files import load_criteria
from meshops.errors import InputError
from meshops.formats import read_deck
from meshops.mesh import ShellMesh
from meshops.sizing import LOCAL, read_samples

CONFIG, RUN, RESULT = "config.toml", "run.json", "result.json"

CRITERIA, SIZES = "criteria.toml", "sizes.csv"
"""What a run judges by, whole: the levels, and the wanted size by place where there is one."""


def about_run(folder: Path) -> dict[str, str]:
    """Return what a run wrote of itself when it began; InputError where none has begun."""
    try:
        about: dict[str, str] = json.loads((folder / RUN).read_text(encoding="utf-8"))
        return {key: about[key] for key in ("source", "mesh", "run")} | about
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError(
            f"{folder} has no {RUN} of a run: name a folder that optimize has written."
        ) from None


def status_of(folder: Path) -> str:
    """Return how a run ended; an empty text where it has not."""
    try:
        return str(json.loads((folder / RESULT).read_text(encoding="utf-8"))["status"])
    except (OSError, ValueError, KeyError, TypeError):
        return ""


def deck_name(folder: Path) -> str:
    """Return the name of the deck that a run writes into its folder."""
    return Path(about_run(folder)["source"]).name


def written_deck(folder: Path) -> Path:
    """Return the deck that a run wrote; InputError where it has written none."""
    deck = folder / deck_name(folder)
    if not deck.is_file():
        raise InputError(f"{folder} has no {deck.name}: the run has not ended yet.")
    return deck


def is_written_deck(path: Path) -> bool:
    """Whether a file is the deck that the run around it wrote."""
    folder = path.parent
    if not all((folder / name).is_file() for name in (CONFIG, RUN, RESULT)):
        return False
    return deck_name(folder) == path.name


def assessment_of_run(folder: Path) -> Assessment:
    """Return what a run judged by: its criteria, size, gradation and surface.

    The surface is that of the deck that the run began with, as long as that is where it was.
    Raises InputError where the folder does not say it.
    """
    about = about_run(folder)
    config = load_config(folder / CONFIG, {})
    size = config.element_size or config.judged_size
    if size is None or not (folder / CRITERIA).is_file():
        raise InputError(
            f"{folder} does not say by what its run judged: an earlier version has written it; "
            "give --criteria and --size."
        )
    sizes = read_samples(folder / SIZES) if (folder / SIZES).is_file() else None
    return Assessment(
        scoring=load_criteria(str(folder / CRITERIA)).at(size),
        sizes=sizes,
        gradation=EVEN if sizes is None else gradation_name(config.size_field or LOCAL),
        reference=_surface(Path(about["source"]), about.get("surface", ""), config.regions),
    )


def _surface(source: Path, digest: str, regions: str | None) -> ShellMesh | None:
    try:
        mesh = read_deck(source, regions=regions).mesh
    except InputError:
        return None
    return mesh if mesh.surface_digest == digest else None
