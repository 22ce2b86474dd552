"""Why nodes and shells of a Nastran deck are locked, in the words of its cards."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from meshops.formats.locks import ELEMENTS_STAY, NODES_STAY, Kind, Lock
from meshops.formats.nastran_case import CaseControl
from meshops.formats.nastran_contents import Contents
from meshops.formats.nastran_nodes import card_name
from meshops.formats.node_attributes import Memberships, SharedMemberships
from meshops.mesh import NO_NODE, Bools, ShellMesh


def locks_of_references(
    mesh: ShellMesh, contents: Contents, case: CaseControl, held: Mapping[str, Bools]
) -> list[Lock]:
    """Locks by cards that name nodes or shells for good."""
    found = []
    for name, other in contents.references.items():
        found.append(_lock("nodes", other.nodes.mask(mesh.node_ids), name))
        found.append(_lock("elements", other.elements.mask(mesh.element_ids), name))
    found.append(_lock("nodes", case.nodes.mask(mesh.node_ids), "case control"))
    found.append(_lock("elements", case.elements.mask(mesh.element_ids), "case control"))
    found += [_lock("nodes", mask, f"a range of {name}") for name, mask in held.items()]
    return [lock for lock in found if lock.count]


def locks_of_memberships(
    elements: np.ndarray, own: Sequence[Memberships], found: SharedMemberships
) -> list[Lock]:
    """Locks where nodes have what the elements around them do not share, or cannot pass on.

    ``elements`` (M, 4) are node rows, ``own`` what each node has.
    """
    nodes: defaultdict[str, set[int]] = defaultdict(set)
    of_elements: defaultdict[str, int] = defaultdict(int)
    for row in np.flatnonzero(found.locked_nodes[elements].any(axis=1)).tolist():
        shared = found.shared[found.region[row]]
        for node in elements[row].tolist():
            if node != NO_NODE and found.locked_nodes[node]:
                for item in own[node]:
                    # a rigid element is a card that names its nodes, and told as such
                    if item.can_grow and (item not in shared or not item.can_shrink):
                        nodes[card_name(item)].add(node)
    for row in np.flatnonzero(found.locked_elements).tolist():
        corners = [own[node] for node in elements[row].tolist() if node != NO_NODE]
        for name in _reasons(corners):
            of_elements[name] += 1
    return [
        *(Lock("nodes", len(rows), name, NODES_STAY) for name, rows in nodes.items()),
        *(Lock("elements", n, name, ELEMENTS_STAY) for name, n in of_elements.items()),
    ]


def _reasons(corners: Sequence[Memberships]) -> set[str]:
    shared = frozenset.intersection(*corners)
    stuck = {card_name(item) for item in shared if not item.can_grow}
    kinds = set.intersection(*({item.kind for item in mine} for mine in corners))
    differ = {item for item in corners[0] if item.kind in kinds and item not in shared}
    return stuck | {f"{card_name(item)} that differs from node to node" for item in differ}


def locks_of_elements(reasons: Iterable[tuple[str, Bools]]) -> list[Lock]:
    """Locks of elements for reasons of their own, such as a thickness that differs by node."""
    found = [_lock("elements", mask, name) for name, mask in reasons]
    return [lock for lock in found if lock.count]


def _lock(kind: Kind, mask: Bools, cards: str) -> Lock:
    return Lock(kind, int(mask.sum()), cards, NODES_STAY if kind == "nodes" else ELEMENTS_STAY)
