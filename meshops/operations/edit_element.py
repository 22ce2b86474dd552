"""EditElement: make other elements of the same nodes (the paper's section 2.3)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from meshops import _core
from meshops.mesh import Bools, Ints
from meshops.operations.candidates import Candidates
from meshops.operations.places import crossable_pairs, nearest_first
from meshops.operations.relax import relax
from meshops.operations.sites import SiteOperation
from meshops.operations.templates import dissections, fill, triples
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class EditElement(SiteOperation):
    """Make two or three adjacent elements anew on the nodes around them.

    The polygon around them is cut along its diagonals to quads, with one tria where its corners
    are odd: a variant is one way to do that. By hand this takes out elements and makes others
    of three or four nodes each; here it is one edit, so no hole is open in between.
    """

    pool: int = 200
    variants: ClassVar[int] = max(len(dissections(corners)) for corners in range(4, 9))
    name: str = "edit-element"
    code: int = 19

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """All ways to make the groups nearest to bad elements anew."""
        mesh, topology = workpiece.mesh, workpiece.topology
        all_elements = np.arange(len(mesh.elements), dtype=np.int32)
        middles = nearest_first(workpiece, all_elements[:, None])[: self.pool]
        two = crossable_pairs(workpiece)
        alone = np.full((len(two), 1), -1, np.int32)
        groups = np.concatenate([np.hstack([two, alone]), triples(topology, middles)])
        groups = groups[nearest_first(workpiece, groups)[: self.pool]]
        polygons, sizes = _core.cavity_polygons(mesh.elements, groups)
        made = fill(polygons, sizes, dissections, -1)
        made[_as_before(mesh.elements, groups, made)] = -1
        added = np.full((len(groups), self.variants, *made.shape[2:]), -1, np.int32)
        added[:, : made.shape[1]] = made
        return relax(
            workpiece,
            Candidates.padded(
                np.repeat(groups, self.variants, axis=0), added.reshape(-1, *added.shape[2:])
            ),
        )

    def format(self, parameters: Ints) -> str:
        """Write groups as ``3.12``: the rank, and the way to cut it from 1."""
        return " ".join(f"{rank}.{variant + 1}" for rank, variant in parameters)


def _as_before(elements: Ints, groups: Ints, made: Ints) -> Bools:
    """(S, V) bool: which of the elements made (S, V, B, 4) are those of the groups (S, W)."""
    old = np.sort(np.where(groups[:, :, None] < 0, -1, elements[groups]), axis=2)
    new = np.sort(made, axis=3)
    same = (new[:, :, :, None] == old[:, None, None]).all(axis=4).any(axis=3)
    as_before: Bools = (same | (made[..., 0] < 0)).all(axis=2)
    return as_before
