"""Subdomains: parts of a mesh around its bad places, each to be improved on its own."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshops.edit import Edit
from meshops.kernels.partition import partition
from meshops.mesh import NEW, NO_NODE, Bools, Floats, Ints, ShellMesh
from meshops.patch import Patch, extract
from meshops.surface import PatchSurface
from meshops.topology import Topology
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
    """

    patch: Patch
    mesh: ShellMesh

    @classmethod
    def of(cls, patch: Patch, sliding: Bools | None = None) -> Subdomain:
        """Make a mesh of a patch; `sliding` (n,) bool: which of its border nodes are not locked."""
        locked = np.zeros(len(patch.points), bool)
        locked[: patch.border_nodes] = True
        if sliding is not None:
            locked &= ~sliding
        region = np.full(len(patch.elements), patch.region)
        mesh = ShellMesh.build(patch.points, patch.elements, region=region, locked_nodes=locked)
        return cls(patch, mesh)

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


def subdomains(workpiece: Workpiece, extent: Extent, turn: int) -> list[Subdomain]:
    """Cut out disjoint subdomains around the bad places of a mesh, worst places first.

    `turn` varies which of equally bad places comes first, so that borders lie elsewhere in another
    round. Zones and subdomains where nothing is left to gain are left out: no element fails, and
    there are no more trias than the parity of their border asks for.
    """
    topology = workpiece.topology
    bad = places(workpiece)
    if not len(bad):
        return []
    bad = np.roll(bad, -(turn * len(bad)) // 3) if turn else bad
    label = partition(
        topology.element_edges,
        topology.edge_elements,
        topology.crossable,
        topology.editable,
        np.ascontiguousarray(bad),
        extent.rings,
        extent.elements,
    )
    chosen = np.nonzero(label >= 0)[0].astype(np.int32)
    order = np.argsort(label[chosen], kind="stable")
    ends = np.cumsum(np.bincount(label[chosen]))[:-1]
    sliding = _Sliding(topology) if workpiece.setting.slides else None
    found = []
    for rows in np.split(chosen[order], ends):
        patch = extract(topology, rows)
        subdomain = Subdomain.of(patch, sliding.inside(patch) if sliding else None)
        trias = np.count_nonzero(subdomain.mesh.is_tria)
        if workpiece.failing[rows].any() or trias > subdomain.least_trias:
            found.append(subdomain)
    return found


class _Sliding:
    """Which border nodes of a patch may slide: those with all their elements in it."""

    def __init__(self, topology: Topology) -> None:
        self._may_slide = topology.sliding_nodes
        self._uses = _uses(topology.mesh.elements, len(topology.mesh.points))

    def inside(self, patch: Patch) -> Bools:
        """(n,) bool by patch node."""
        uses = _uses(patch.elements, len(patch.points))
        inside: Bools = self._may_slide[patch.nodes] & (uses == self._uses[patch.nodes])
        return inside


def _uses(elements: Ints, nodes: int) -> Ints:
    return np.bincount(elements[elements != NO_NODE], minlength=nodes).astype(np.int32)


def places(workpiece: Workpiece) -> Ints:
    """Rows of the failing elements and superfluous trias in zones that can gain, worst first."""
    topology, mesh = workpiece.topology, workpiece.mesh
    zones = topology.zones
    count = int(zones.max()) + 1 if len(zones) else 0
    inside = zones >= 0
    if not count:
        return np.zeros(0, np.int32)
    trias = np.bincount(zones[inside & mesh.is_tria], minlength=count)
    failing = np.bincount(zones[inside & workpiece.failing], minlength=count)
    excess = trias > zone_border_edges(workpiece) % 2
    bad = (workpiece.failing | (mesh.is_tria & excess[zones])) & inside
    bad &= (failing > 0)[zones] | excess[zones]
    rows = workpiece.bad_elements
    return rows[bad[rows]]


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
