"""Milestones as plain figures and arrays, which a checkpoint can hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from numpy.typing import NDArray

from islands.archipelago import Group, Milestone
from islands.island import IslandState
from islands.migration import Migrants
from islands.procedure import Place, Round, Step, read_round, round_document
from meshops.operations import ALL_OPERATIONS

Arrays = Mapping[str, NDArray[Any]]

_ARRAYS = ("genomes", "fitness", "tallies", "best_tally", "leaving")
_MIGRANTS = tuple(field.name for field in fields(Migrants))


def milestone_figures(milestone: Milestone) -> dict[str, Any]:
    """All of a milestone that JSON can hold."""
    return {
        "work": milestone.work,
        "islands": [_island_figures(state) for state in milestone.islands],
        "travelling": [[g.source, g.target, g.arrival] for g in milestone.travelling],
        "is_last": milestone.is_last,
        "reasons": list(milestone.reasons),
    }


def milestone_arrays(milestone: Milestone) -> dict[str, NDArray[Any]]:
    """All else, by names of its own."""
    found = {}
    for state in milestone.islands:
        for name in _ARRAYS:
            found[f"island.{state.island}.{name}"] = getattr(state, name)
    for number, group in enumerate(milestone.travelling):
        for name in _MIGRANTS:
            found[f"group.{number}.{name}"] = getattr(group.migrants, name)
    return found


def read_milestone(figures: Mapping[str, Any], arrays: Arrays) -> Milestone:
    """Put a milestone together again; who has just left was told before."""
    islands = []
    for i, known in enumerate(figures["islands"]):
        values: dict[str, Any] = dict(known)
        values |= {"best_steps": _steps(known["best_steps"]), "faults": tuple(known["faults"])}
        values |= {name: arrays[f"island.{i}.{name}"].copy() for name in _ARRAYS}
        islands.append(IslandState(**values))
    groups = []
    for i, (source, target, arrival) in enumerate(figures["travelling"]):
        migrants = Migrants(*(arrays[f"group.{i}.{name}"].copy() for name in _MIGRANTS))
        groups.append(Group(source, target, arrival, migrants))
    return Milestone(
        work=figures["work"],
        islands=tuple(islands),
        left=(),
        travelling=tuple(groups),
        is_last=figures["is_last"],
        reasons=tuple(figures["reasons"]),
    )


def _island_figures(state: IslandState) -> dict[str, Any]:
    figures = {f.name: getattr(state, f.name) for f in fields(state) if f.name not in _ARRAYS}
    whole = Round(None, 0, (Place((0.0, 0.0, 0.0), state.best_steps),))
    return figures | {"best_steps": round_document(whole, ALL_OPERATIONS)}


def _steps(document: Any) -> tuple[Step, ...]:
    return read_round(document, ALL_OPERATIONS).places[0].steps
