"""Several sections of bulk data as one mesh: each superelement counts its own nodes and shells.

Where numbers come twice, those of superelement n are n,000,000,000 and more in the mesh.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from meshops.mesh import NEW, NO_NODE, Bools, Floats, Ids, Ints, ShellMesh

_STEP = 10**9
"""More than the largest id of a deck."""

_ATTACHED = 1e-5
"""Nodes of two sections that are nearer, relative to the size of the mesh, are joined."""


@dataclass(frozen=True, eq=False)
class Union:
    """The meshes of sections as one.

    Attributes
    ----------
    mesh : ShellMesh
    shifts : list of int
        What the ids of each section are raised by.
    first_region : (P + 1,) int64
        Where the regions of each section start.
    parts : list of ShellMesh
    """

    mesh: ShellMesh
    shifts: list[int]
    first_region: Ids
    parts: list[ShellMesh]

    @classmethod
    def of(cls, parts: Sequence[ShellMesh], numbers: Sequence[int]) -> Union:
        """Unite the meshes of sections, whose numbers are those of their superelements."""
        if len(parts) == 1:
            regions = np.array([0, int(parts[0].region.max()) + 1])
            return cls(parts[0], [0], regions, list(parts))
        clash = any(_has_twice([getattr(p, name) for p in parts]) for name in _IDS)
        shifts = [number * _STEP if clash else 0 for number in numbers]
        first = np.cumsum([0, *(int(part.region.max()) + 1 for part in parts)])
        rows = np.cumsum([0, *(len(part.points) for part in parts)])
        mesh = ShellMesh.build(
            np.concatenate([part.points for part in parts]),
            np.concatenate(
                [_shifted(p.elements, int(r), NO_NODE) for p, r in zip(parts, rows, strict=False)]
            ),
            region=np.concatenate([p.region + r for p, r in zip(parts, first, strict=False)]),
            locked_nodes=np.concatenate([part.locked_nodes for part in parts]),
            locked_elements=np.concatenate([part.locked_elements for part in parts]),
            node_ids=np.concatenate([p.node_ids + s for p, s in zip(parts, shifts, strict=True)]),
            element_ids=np.concatenate(
                [p.element_ids + s for p, s in zip(parts, shifts, strict=True)]
            ),
        )
        return cls(mesh, shifts, first, list(parts))

    def split(self, mesh: ShellMesh) -> list[ShellMesh]:
        """Part into the meshes of the sections a mesh that descends from the united one."""
        if len(self.parts) == 1:
            return [mesh]
        owner = np.searchsorted(self.first_region, mesh.region, side="right") - 1
        found = []
        for number, (part, shift) in enumerate(zip(self.parts, self.shifts, strict=True)):
            mine = owner == number
            used = np.isin(mesh.node_ids, part.node_ids + shift) & (mesh.node_ids != NEW)
            corners = mesh.elements[mine]
            used[corners[corners != NO_NODE]] = True
            row = np.cumsum(used) - 1
            found.append(
                ShellMesh.build(
                    mesh.points[used],
                    np.where(corners == NO_NODE, NO_NODE, row[corners]),
                    region=mesh.region[mine] - self.first_region[number],
                    locked_nodes=mesh.locked_nodes[used],
                    locked_elements=mesh.locked_elements[mine],
                    node_ids=_shifted(mesh.node_ids[used], -shift, NEW),
                    element_ids=_shifted(mesh.element_ids[mine], -shift, NEW),
                )
            )
        return found


_IDS = ("node_ids", "element_ids")


def attached(points: Floats, others: Floats) -> Bools:
    """(N,) bool: which points have one of the others in their place, as where parts are joined."""
    if not (len(points) and len(others)):
        return np.zeros(len(points), bool)
    size = float(np.ptp(points, axis=0).max())
    distance = KDTree(others).query(points)[0]
    near: Bools = distance <= _ATTACHED * size
    return near


def _has_twice(ids: Sequence[Ids]) -> bool:
    every = np.concatenate(ids)
    return len(np.unique(every)) < len(every)


def _shifted(values: Ids | Ints, by: int, but: int) -> Ids:
    shifted: Ids = np.where(values == but, but, values + by)
    return shifted
