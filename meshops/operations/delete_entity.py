"""DeleteEntity: take out elements without which the mesh is still whole (section 2.3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops._core import has_doubles
from meshops.edit import Edit
from meshops.mesh import NO_NODE, Floats, Ids, Ints, ShellMesh
from meshops.quality_sums import TALLY_SIZE
from meshops.workpiece import Workpiece

DOUBLED, COLLAPSED, ISLAND = 1, 2, 3
KINDS = {DOUBLED: "doubled", COLLAPSED: "collapsed", ISLAND: "island"}


@dataclass(frozen=True)
class DeleteEntity:
    """Take out elements that are in the mesh too much.

    In the paper's software elements are deleted by hand, before others are made in the hole. Here
    no operation opens a hole, and what is made anew is one edit (EditElement). So what is left to
    delete stands free: elements whose nodes another one has too, elements that are collapsed to a
    line, and islands, which share no node with the rest. A parameter row is (kind, rank from 1).

    A search only takes doubled and collapsed elements: an island may be a part of the model, and
    deleting it would always make the mesh better. Nodes need no deleting, because every edit drops
    those that no element uses.

    Attributes
    ----------
    picks : int
        How many deletions an individual has at the most.
    largest_island : int
        Elements of an island.
    """

    picks: int = 4
    largest_island: int = 20
    name: str = "delete-entity"
    code: int = 17

    def search_space(
        self, workpiece: Workpiece, rng: np.random.Generator
    ) -> DeleteEntitySpace | None:
        """Doubled and collapsed elements; the random generator is not needed."""
        space = DeleteEntitySpace(self, workpiece)
        return space if len(space.choices) else None

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Delete entities (K, 2); a rank that the mesh does not have is skipped."""
        if not len(parameters):
            return Edit()
        if not np.isin(parameters[:, 0], list(KINDS)).all():
            raise ValueError(f"the kind of an entity must be one of {list(KINDS)}")
        found = self.entities(workpiece)
        removed = [
            found[kind][rank - 1]
            for kind, rank in parameters.tolist()
            if 1 <= rank <= len(found[kind])
        ]
        return Edit(removed=np.unique(np.concatenate([np.zeros(0, np.int32), *removed])))

    def entities(self, workpiece: Workpiece) -> dict[int, list[Ints]]:
        """Rows of the elements of all that may be deleted, by kind; small islands first."""
        mesh = workpiece.mesh
        editable = workpiece.topology.editable
        return {
            DOUBLED: [row for row in doubled(workpiece)[:, None] if editable[row].all()],
            COLLAPSED: [row for row in collapsed(mesh)[:, None] if editable[row].all()],
            ISLAND: islands(mesh, self.largest_island),
        }

    def format(self, parameters: Ints) -> str:
        """Write entities as ``doubled 3``."""
        return " ".join(f"{KINDS[kind]} {rank}" for kind, rank in parameters.tolist())


class DeleteEntitySpace:
    """Choices of doubled and collapsed elements; a gene beyond them deletes nothing."""

    def __init__(self, operation: DeleteEntity, workpiece: Workpiece) -> None:
        self.operation = operation
        self.workpiece = workpiece
        found = operation.entities(workpiece)
        self.choices: Ints = np.array(
            [(kind, rank + 1) for kind in (DOUBLED, COLLAPSED) for rank in range(len(found[kind]))],
            np.int32,
        ).reshape(-1, 2)
        self.bounds: Ids = np.full(operation.picks, len(self.choices) + 1, np.int64)

    def draw(self, rng: np.random.Generator, count: int) -> Ids:
        """Numbers drawn evenly."""
        return rng.integers(0, self.bounds, (count, len(self.bounds)))

    def parameters(self, genome: Ids) -> Ints:
        """(K, 2): kind and rank."""
        chosen: Ints = self.choices[np.unique(genome[genome < len(self.choices)])]
        return chosen

    def evaluate(self, genomes: Ids) -> Floats:
        """Delete what each genome names."""
        return np.stack([self.tally(genome) for genome in genomes])

    def tally(self, genome: Ids) -> Floats:
        """Delete what one genome names."""
        edit = self.operation.apply(self.workpiece, self.parameters(genome))
        if edit.is_empty:
            return np.full(TALLY_SIZE, np.nan)
        return self.workpiece.tally + self.workpiece.tally_change(edit)


def doubled(workpiece: Workpiece) -> Ints:
    """Rows of the elements all of whose nodes another element of their region has, ascending.

    Of several, one stays: a quad rather than a tria in it, then one that must stay, then the first.
    """
    mesh, editable = workpiece.mesh, workpiece.topology.editable
    if not has_doubles(mesh.elements, len(mesh.points)):
        return np.zeros(0, np.int32)
    nodes = [frozenset(element[element >= 0].tolist()) for element in mesh.elements]
    rank = {row: (-len(nodes[row]), bool(editable[row]), row) for row in range(len(nodes))}
    around: dict[int, list[int]] = {}
    for row in sorted(rank, key=rank.__getitem__):
        for node in nodes[row]:
            around.setdefault(node, []).append(row)
    found = []
    for row, own in enumerate(nodes):
        # the elements at a node are in the order in which they stay
        for other in around[min(own)]:
            if other == row:
                break
            if own <= nodes[other] and mesh.region[other] == mesh.region[row]:
                found.append(row)
                break
    return np.array(found, np.int32)


def collapsed(mesh: ShellMesh) -> Ints:
    """Rows of the elements that lie on a line of edges, each in both directions, ascending.

    Their own border is empty, so the border of the mesh is the same without them.
    """
    size = np.where(mesh.is_tria, 3, 4)[:, None]
    corner = np.arange(4)
    start = np.where(corner < size, mesh.elements, NO_NODE)
    end = np.take_along_axis(start, (corner + 1) % size, axis=1)
    end[start == NO_NODE] = NO_NODE
    low, high = np.minimum(start, end), np.maximum(start, end)
    direction = np.sign(end - start)
    same = (low[:, :, None] == low[:, None]) & (high[:, :, None] == high[:, None])
    balanced = (same * direction[:, None]).sum(axis=2) == 0
    return np.nonzero(balanced.all(axis=1))[0].astype(np.int32)


def islands(mesh: ShellMesh, largest: int) -> list[Ints]:
    """Rows of the elements of each island with no more than so many, the smallest first.

    An island shares no node with other elements, has nothing locked, and is not the largest part.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    rows, nodes = np.repeat(np.arange(len(mesh.elements)), 4), mesh.elements.ravel()
    used = nodes >= 0
    rows, nodes = rows[used], nodes[used]
    count = len(mesh.elements) + len(mesh.points)
    ties = (np.ones(len(rows), np.int8), (rows, len(mesh.elements) + nodes))
    _, label = connected_components(coo_array(ties, shape=(count, count)), directed=False)
    part = label[: len(mesh.elements)]
    held = np.bincount(part[mesh.locked_elements], minlength=count)
    held += np.bincount(part[rows[mesh.locked_nodes[nodes]]], minlength=count)
    sizes = np.bincount(part, minlength=count)
    held[np.argmax(sizes)] += 1
    small = np.nonzero((sizes > 0) & (sizes <= largest) & (held == 0))[0]
    found = [np.nonzero(part == label)[0].astype(np.int32) for label in small]
    return sorted(found, key=lambda rows: (len(rows), rows[0]))
