"""Several meshes of one deck as one: each part and superelement counts its own nodes and shells.

Where numbers come twice, those of part n are n,000,000,000 and more in the mesh.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from meshops.mesh import NEW, NO_NODE, Bools, Ids, Ints, ShellMesh

_STEP = 10**9
"""More than the largest id of a deck."""

_IDS = ("node_ids", "element_ids")


@dataclass(frozen=True, eq=False)
class Union:
    """The meshes of parts as one.

    Attributes
    ----------
    mesh : ShellMesh
    shifts : list of int
        What the ids of each part are raised by.
    first_region : (P + 1,) int64
        Where the regions of each part start.
    parts : list of ShellMesh
    numbers : list of int
        Of the parts.
    """

    mesh: ShellMesh
    shifts: list[int]
    first_region: Ids
    parts: list[ShellMesh]
    numbers: list[int]

    @classmethod
    def of(cls, parts: Sequence[ShellMesh], numbers: Sequence[int]) -> Union:
        """Unite the meshes of parts; a number is that of a superelement, or of a part in order."""
        if len(parts) == 1:
            regions = np.array([0, int(parts[0].region.max()) + 1])
            return cls(parts[0], [0], regions, list(parts), [0])
        shifts = _shifts(parts, numbers)
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
        return cls(mesh, shifts, first, list(parts), list(numbers))

    def split(self, mesh: ShellMesh) -> list[ShellMesh]:
        """Part into the meshes of the parts a mesh that descends from the united one."""
        if len(self.parts) == 1:
            return [mesh]
        found = []
        for number, (used, mine) in enumerate(self._owned(mesh)):
            shift, corners = self.shifts[number], mesh.elements[mine]
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

    def numbered(self, mesh: ShellMesh, parts: Sequence[ShellMesh]) -> ShellMesh:
        """Give a united mesh the ids that its parts have, as `split` parts it.

        They are raised as where the deck is read again.
        """
        if len(parts) == 1:
            return parts[0]
        node_ids, element_ids = mesh.node_ids.copy(), mesh.element_ids.copy()
        elements = mesh.elements.copy()
        shifts = _shifts(parts, self.numbers)
        for part, shift, (used, mine) in zip(parts, shifts, self._owned(mesh), strict=True):
            rows = np.flatnonzero(used)
            node_ids[used] = part.node_ids + shift
            element_ids[mine] = part.element_ids + shift
            elements[mine] = np.where(part.elements == NO_NODE, NO_NODE, rows[part.elements])
        return ShellMesh.build(
            mesh.points,
            elements,
            region=mesh.region,
            locked_nodes=mesh.locked_nodes,
            locked_elements=mesh.locked_elements,
            node_ids=node_ids,
            element_ids=element_ids,
        )

    def part_of(self, region: int) -> tuple[int, int]:
        """Return the number of the part of a region in their order, and its region there."""
        number = int(np.searchsorted(self.first_region, region, side="right")) - 1
        return number, region - int(self.first_region[number])

    def _owned(self, mesh: ShellMesh) -> Iterator[tuple[Bools, Bools]]:
        """Yield the nodes (N,) and the elements (M,) of each part."""
        owner = np.searchsorted(self.first_region, mesh.region, side="right") - 1
        for number, (part, shift) in enumerate(zip(self.parts, self.shifts, strict=True)):
            mine = owner == number
            used = np.isin(mesh.node_ids, part.node_ids + shift) & (mesh.node_ids != NEW)
            corners = mesh.elements[mine]
            used[corners[corners != NO_NODE]] = True
            yield used, mine


def _shifts(parts: Sequence[ShellMesh], numbers: Sequence[int]) -> list[int]:
    clash = any(_has_twice([getattr(part, name) for part in parts]) for name in _IDS)
    return [number * _STEP if clash else 0 for number in numbers]


def _has_twice(ids: Sequence[Ids]) -> bool:
    every = np.concatenate(ids)
    return len(np.unique(every)) < len(every)


def _shifted(values: Ids | Ints, by: int, but: int) -> Ids:
    shifted: Ids = np.where(values == but, but, values + by)
    return shifted
