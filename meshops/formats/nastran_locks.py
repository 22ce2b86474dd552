"""Why nodes and shells of a Nastran deck are locked, in the words of its cards."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from meshops.formats.locks import Lock, lock_of
from meshops.formats.nastran_case import CaseControl
from meshops.formats.nastran_contents import Contents
from meshops.formats.nastran_nodes import card_name
from meshops.formats.node_attributes import Memberships, SharedMemberships
from meshops.mesh import NO_NODE, Bools, ShellMesh


def locks_of_references(
    mesh: ShellMesh, contents: Contents, case: CaseControl, held: Mapping[str, Bools]
) -> list[Lock]:
    """Locks by cards that name nodes or shells for good."""
    nodes, elements = mesh.node_ids, mesh.element_ids
    named = [(name, other.nodes, other.elements) for name, other in contents.references.items()]
    found = []
    for name, of_nodes, of_elements in [*named, ("case control", case.nodes, case.elements)]:
        found.append(lock_of("nodes", nodes[of_nodes.mask(nodes)], name))
        found.append(lock_of("elements", elements[of_elements.mask(elements)], name))
    found += [lock_of("nodes", nodes[mask], f"a range of {name}") for name, mask in held.items()]
    return [lock for lock in found if lock.count]


def locks_of_memberships(
    mesh: ShellMesh, own: Sequence[Memberships], found: SharedMemberships
) -> list[Lock]:
    """Locks where nodes have what the elements around them do not share, or cannot pass on.

    ``own`` is what each node of the mesh has.
    """
    elements = mesh.elements
    nodes: defaultdict[str, set[int]] = defaultdict(set)
    of_elements: defaultdict[str, list[int]] = defaultdict(list)
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
            of_elements[name].append(row)
    return [
        *(lock_of("nodes", mesh.node_ids[sorted(rows)], name) for name, rows in nodes.items()),
        *(lock_of("elements", mesh.element_ids[rows], name) for name, rows in of_elements.items()),
    ]


def _reasons(corners: Sequence[Memberships]) -> set[str]:
    shared = frozenset.intersection(*corners)
    stuck = {card_name(item) for item in shared if not item.can_grow}
    kinds = set.intersection(*({item.kind for item in mine} for mine in corners))
    differ = {item for item in corners[0] if item.kind in kinds and item not in shared}
    return stuck | {f"{card_name(item)} that differs from node to node" for item in differ}


def locks_of_elements(mesh: ShellMesh, reasons: Iterable[tuple[str, Bools]]) -> list[Lock]:
    """Locks of elements for reasons of their own, such as a thickness that differs by node."""
    found = [lock_of("elements", mesh.element_ids[mask], name) for name, mask in reasons]
    return [lock for lock in found if lock.count]
