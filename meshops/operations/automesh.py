"""Automesh: mesh a whole zone anew from its border alone (the paper's section 2.3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops.edit import Edit
from meshops.mesh import Floats, Ids, Ints
from meshops.methods import METHODS
from meshops.patch import join
from meshops.quality_sums import TALLY_SIZE
from meshops.remeshing import replace_patch
from meshops.workpiece import Workpiece

SIZES = (100, 90, 110, 80, 125)
"""Percent of the edge length of the run, or of the zone as it is."""

MOST_ZONES = 100
"""Zones beyond this rank are left to other operations."""


@dataclass(frozen=True)
class Automesh:
    """Mesh one zone, the largest area within barriers, anew within its border.

    A genome is the rank of a zone, a method and a size.
    """

    name: str = "automesh"
    code: int = 16

    def search_space(self, workpiece: Workpiece, rng: np.random.Generator) -> AutomeshSpace | None:
        """Genomes are zones; the random generator is not needed."""
        zones = ranked_zones(workpiece)
        return AutomeshSpace(workpiece, zones[:MOST_ZONES]) if zones else None

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Mesh zones (K, 3) anew: rank from 1, method, percent of the size.

        A rank that the mesh does not have is left out, and so is a zone that comes again.
        """
        zones = ranked_zones(workpiece)
        edits: dict[int, Edit] = {}
        for rank, method, percent in parameters.tolist():
            if not (0 <= method < len(METHODS) and percent > 0):
                raise ValueError(f"automesh has no method {method} or size of {percent} percent")
            if 1 <= rank <= len(zones) and rank not in edits:
                edits[rank] = _mesh_zone(workpiece, zones[rank - 1], method, percent)[0]
        return join(workpiece.mesh, [edit for edit in edits.values() if not edit.is_empty])

    def format(self, parameters: Ints) -> str:
        """Zones as ``2 front 90%``."""
        return " ".join(
            f"{rank} {METHODS[method].name} {percent}%" for rank, method, percent in parameters
        )


class AutomeshSpace:
    """Zones of one mesh. A zone that was meshed once by a method and size is remembered."""

    def __init__(self, workpiece: Workpiece, zones: list[Ints]) -> None:
        self.workpiece = workpiece
        self.bounds: Ids = np.array([len(zones), len(METHODS), len(SIZES)], np.int64)
        self._zones = zones
        self._tallies: dict[tuple[int, ...], Floats] = {}

    def draw(self, rng: np.random.Generator, count: int) -> Ids:
        """Bad zones more often than others, half of the genomes at the size as it is."""
        genomes = rng.integers(0, self.bounds, (count, 3))
        genomes[:, 0] = (self.bounds[0] * rng.random(count) ** 2).astype(np.int64)
        genomes[rng.random(count) < 0.5, 2] = 0
        return genomes

    def evaluate(self, genomes: Ids) -> Floats:
        """Mesh the zone of each genome."""
        return np.stack([self.tally(genome) for genome in genomes])

    def tally(self, genome: Ids) -> Floats:
        """Tally after meshing one zone anew; NaN where no valid mesh comes out."""
        key = tuple(genome.tolist())
        if key not in self._tallies:
            zone, method, size = key
            edit, change = _mesh_zone(self.workpiece, self._zones[zone], method, SIZES[size])
            self._tallies[key] = (
                np.full(TALLY_SIZE, np.nan) if edit.is_empty else self.workpiece.tally + change
            )
        return self._tallies[key]

    def parameters(self, genome: Ids) -> Ints:
        """(1, 3) int32: rank from 1, method, percent; no row where no valid mesh comes out."""
        zone, method, size = genome.tolist()
        rows = np.array([[zone + 1, method, SIZES[size]]], np.int32)
        return rows if np.isfinite(self.tally(genome)).any() else rows[:0]


def ranked_zones(workpiece: Workpiece) -> list[Ints]:
    """Rows of the elements of each zone, ascending; the zone with most bad ones first.

    Bad are those that fail and trias. Equals come in the order of their first element.
    """
    zones = workpiece.topology.zones
    rows = np.nonzero(zones >= 0)[0].astype(np.int32)
    if not len(rows):
        return []
    number = zones[rows]
    bad = (workpiece.failing | workpiece.mesh.is_tria)[rows]
    badness = np.bincount(number, weights=bad)
    by_zone = np.split(rows[np.argsort(number, kind="stable")], np.cumsum(np.bincount(number))[:-1])
    return [by_zone[zone] for zone in np.argsort(-badness, kind="stable")]


def _mesh_zone(workpiece: Workpiece, rows: Ints, method: int, percent: int) -> tuple[Edit, Floats]:
    return replace_patch(workpiece, rows, method=METHODS[method].remesh, scale=percent / 100.0)
