"""Holding: what keeps an element as it is, in words for its engineer."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

import numpy as np

from meshops.formats.locks import Kind, Lock
from meshops.mesh import NO_NODE, Ids, Ints, ShellMesh
from meshops.topology import Topology

SHOWN = 3
"""How many locked nodes are named one by one."""

BORDER = "at a border"
T_JUNCTION = "at a T-junction"
REGIONS = "at an edge between two properties"
LOCKED = "beside a locked element"
FEATURE = "at a feature edge"


def what_holds(
    mesh: ShellMesh, rows: Ids, found: Topology, locks: Sequence[Lock]
) -> tuple[str, ...]:
    """Say of some elements what keeps them as they are; an empty text where nothing does.

    Parameters
    ----------
    mesh : ShellMesh
        With the ids of its deck.
    rows : (K,) int
        Of the elements.
    found : Topology
        Of the mesh.
    locks : sequence of Lock
        What the deck says of its locks.
    """
    cards = {kind: _cards(locks, kind) for kind in ("nodes", "elements")}
    edges = _kinds_of_edges(found)
    texts = []
    for row in rows.tolist():
        nodes = mesh.elements[row][mesh.elements[row] != NO_NODE]
        sides = found.element_edges[row][found.element_edges[row] >= 0]
        reasons = [
            *_lock_of_element(mesh, row, found, cards["elements"]),
            *_locks_of_nodes(mesh, nodes, cards["nodes"]),
            *dict.fromkeys(kind for kind in (edges[side] for side in sides) if kind),
        ]
        texts.append("; ".join(reasons))
    return tuple(texts)


def _cards(locks: Iterable[Lock], kind: Kind) -> dict[int, list[str]]:
    """Which cards lock each id."""
    found: dict[int, list[str]] = defaultdict(list)
    for lock in locks:
        for number in lock.ids if lock.kind == kind else ():
            found[number].append(lock.cards)
    return found


def _lock_of_element(
    mesh: ShellMesh, row: int, found: Topology, cards: dict[int, list[str]]
) -> list[str]:
    if mesh.locked_elements[row]:
        named = cards.get(int(mesh.element_ids[row]), ["other cards"])
        return [f"locked by {', '.join(named)}"]
    return ["a locked node needs it"] if found.anchors[row] else []


def _locks_of_nodes(mesh: ShellMesh, nodes: Ints, cards: dict[int, list[str]]) -> list[str]:
    ids = [int(mesh.node_ids[node]) for node in nodes if mesh.locked_nodes[node]]
    if not ids:
        return []
    named = dict.fromkeys(card for node in ids for card in cards.get(node, ["other cards"]))
    shown = ", ".join(map(str, ids[:SHOWN])) + ", ..." * (len(ids) > SHOWN)
    return [f"locked node{'s' * (len(ids) > 1)} {shown} ({', '.join(named)})"]


def _kinds_of_edges(found: Topology) -> list[str]:
    """Of each edge what barrier it is; an empty text where it is none."""
    mesh, edges = found.mesh, found.edge_elements
    left, right = edges.T
    names = np.full(len(found.edges), FEATURE, object)
    names[mesh.locked_elements[left] | mesh.locked_elements[right]] = LOCKED
    names[mesh.region[left] != mesh.region[right]] = REGIONS
    names[found.is_border] = BORDER
    names[found.is_t_junction] = T_JUNCTION
    names[found.crossable] = ""
    kinds: list[str] = names.tolist()
    return kinds
