"""Subdomains: parts of a mesh around its bad places, each to be improved on its own."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from meshops.edit import Edit
from meshops.mesh import NEW, NO_NODE, Floats, Ints, ShellMesh
from meshops.patch import Patch, extract_each
from meshops.surface import PatchSurface
from meshops.topology import Topology, valences
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class Extent:
    """How large subdomains are.

    Attributes
    ----------
    rings : int
        Crossable edges from the bad element in the middle to the elements at the border.
    elements : int
        The most elements that a subdomain has.
    """

    rings: int
    elements: int


@dataclass(frozen=True, eq=False)
class Subdomain:
    """Connected elements of one zone as a mesh of its own, whose border stays in its line.

    Attributes
    ----------
    patch : Patch
        Where it comes from.
    mesh : ShellMesh
        Its border nodes come first and are locked, but for those that may slide along a border of
        the mesh; ids are rows of the patch plus 1.
    outside : (b,) int32
        Elements of the mesh around it that meet at each border node; -1 where any number may.
    """

    patch: Patch
    mesh: ShellMesh
    outside: Ints

    @classmethod
    def of(cls, topology: Topology, patch: Patch, *, slides: bool) -> Subdomain:
        """Make a mesh of a patch that was cut out of a mesh with this topology.

        With `slides` the nodes that may slide along a border of the mesh are not locked, where all
        elements around them are of the patch.
        """
        border = patch.nodes[: patch.border_nodes]
        outside = topology.valence[border]
        outside -= valences(patch.elements, len(patch.points))[: patch.border_nodes]
        locked = np.zeros(len(patch.points), bool)
        locked[: patch.border_nodes] = True
        if slides:
            locked[: patch.border_nodes] = ~topology.sliding_nodes[border] | (outside > 0)
        region = np.full(len(patch.elements), patch.region)
        mesh = ShellMesh.build(patch.points, patch.elements, region=region, locked_nodes=locked)
        outside[~topology.inner_nodes[border]] = -1
        return cls(patch, mesh, outside)

    @cached_property
    def surface(self) -> PatchSurface:
        """The surface of the subdomain as it is."""
        return PatchSurface.of(self.patch.points, self.patch.elements)

    @property
    def least_trias(self) -> int:
        """Fewest trias that its border allows: its number of border edges modulo 2."""
        return len(self.patch.border) % 2

    @property
    def centre(self) -> Floats:
        """(3,) mean of its nodes."""
        centre: Floats = self.patch.points.mean(axis=0)
        return centre

    def edit(self, mesh: ShellMesh, after: ShellMesh) -> Edit:
        """Return what turns the subdomain into `after`, as an edit of the mesh around it.

        Elements and nodes that are as they were stay untouched.
        """
        patch = self.patch
        was = after.node_ids - 1
        kept = was >= 0
        rows = np.empty(len(after.points), np.int32)
        rows[kept] = patch.nodes[was[kept]]
        rows[~kept] = len(mesh.points) + np.arange(np.count_nonzero(~kept), dtype=np.int32)
        elements = np.where(after.elements == NO_NODE, np.int32(NO_NODE), rows[after.elements])
        moved = np.nonzero(kept)[0][(after.points[kept] != patch.points[was[kept]]).any(axis=1)]
        origin = after.element_ids - 1
        stays = after.element_ids != NEW
        gone = np.ones(len(patch.rows), bool)
        gone[origin[stays]] = False
        own = patch.rows[origin[stays]]
        changed = (mesh.elements[own] != elements[stays]).any(axis=1)
        added = elements[~stays]
        return Edit(
            removed=patch.rows[gone],
            rewired=own[changed],
            rewired_to=elements[stays][changed],
            added_points=after.points[~kept],
            added_elements=added,
            added_region=np.full(len(added), patch.region, np.int32),
            moved=rows[moved],
            moved_to=after.points[moved],
        )


Aim = Literal["faults", "flow", "tidy"]
"""What subdomains are cut out for: failing elements and trias, irregular nodes, or those of new
elements alone."""


def subdomains(
    workpiece: Workpiece, extent: Extent, turn: int, aim: Aim = "faults"
) -> list[Subdomain]:
    """Cut out disjoint subdomains around the bad places of a mesh, worst places first.

    `turn` varies which of equally bad places comes first, so that borders lie elsewhere in another
    round. Of faults, zones and subdomains where nothing is left to gain are left out: no element
    fails, and there are no more trias than the parity of their border asks for.
    """
    topology = workpiece.topology
    bad = places(workpiece) if aim == "faults" else irregular_places(workpiece, aim)
    if not len(bad):
        return []
    bad = np.roll(bad, -(turn * len(bad)) // 3) if turn else bad
    label = topology.graph.partition(topology.editable, bad, extent.rings, extent.elements)
    chosen = np.nonzero(label >= 0)[0].astype(np.int32)
    order = np.argsort(label[chosen], kind="stable")
    ends = np.cumsum(np.bincount(label[chosen]))[:-1]
    # The sides of all elements are odd in number where the trias are, and so is the border, since
    # each inner edge has two sides: one tria is what the border asks for, two are not.
    failing, is_tria = workpiece.mendable, workpiece.mesh.is_tria
    gaining = [
        rows
        for rows in np.split(chosen[order], ends)
        if aim != "faults" or failing[rows].any() or np.count_nonzero(is_tria[rows]) > 1
    ]
    slides = workpiece.setting.slides
    return [
        Subdomain.of(topology, patch, slides=slides) for patch in extract_each(topology, gaining)
    ]


def places(workpiece: Workpiece) -> Ints:
    """Rows of the failing elements and superfluous trias in zones that can gain, worst first."""
    topology, mesh = workpiece.topology, workpiece.mesh
    zones = topology.zones
    count = int(zones.max()) + 1 if len(zones) else 0
    inside = zones >= 0
    if not count:
        return np.zeros(0, np.int32)
    trias = np.bincount(zones[inside & mesh.is_tria], minlength=count)
    failing = np.bincount(zones[inside & workpiece.mendable], minlength=count)
    excess = trias > zone_border_edges(workpiece) % 2
    bad = (workpiece.mendable | (mesh.is_tria & excess[zones])) & inside
    bad &= (failing > 0)[zones] | excess[zones]
    rows = workpiece.bad_elements
    return rows[bad[rows]]


def irregular_places(workpiece: Workpiece, aim: Aim) -> Ints:
    """Rows of the elements with irregular nodes, or irregular ones of new elements; most first."""
    elements, irregular = workpiece.mesh.elements, workpiece.irregular
    if aim == "tidy":
        new = elements[workpiece.mesh.element_ids == NEW]
        irregular = irregular & np.isin(np.arange(len(irregular)), new)
    count = np.count_nonzero(irregular[elements] & (elements != NO_NODE), axis=1)
    chosen = np.nonzero((count > 0) & workpiece.topology.editable)[0]
    order = np.argsort(-count[chosen], kind="stable")
    return chosen[order].astype(np.int32)


def zone_border_edges(workpiece: Workpiece) -> Ints:
    """(Z,) int: how many edges the border of each zone has."""
    topology = workpiece.topology
    zones, edges = topology.zones, topology.element_edges
    count = int(zones.max()) + 1 if len(zones) else 0
    is_side = (edges >= 0) & (zones >= 0)[:, None]
    pair = topology.edge_elements[edges]
    inner = topology.crossable[edges] & (zones[pair[..., 0]] == zones[pair[..., 1]])
    owner = np.broadcast_to(zones[:, None], edges.shape)
    return np.bincount(owner[is_side & ~inner], minlength=count).astype(np.int32)
