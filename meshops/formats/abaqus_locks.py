"""What of an Abaqus part is locked, and by which keywords."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from meshops.formats.abaqus_nodes import NodeAttributes
from meshops.formats.abaqus_regions import ElementFacts
from meshops.formats.abaqus_sets import NamedSets
from meshops.formats.abaqus_uses import Uses
from meshops.formats.locks import Lock, lock_of
from meshops.formats.node_attributes import SharedMemberships
from meshops.mesh import NO_NODE, Bools, ShellMesh


@dataclass(eq=False)
class Locks:
    """Masks of locked nodes and elements, by what locks them.

    Attributes
    ----------
    nodes : dict of str to (N,) bool
    elements : dict of str to (M,) bool
    """

    nodes: dict[str, Bools] = field(default_factory=dict)
    elements: dict[str, Bools] = field(default_factory=dict)

    def masks(self, mesh: ShellMesh) -> tuple[Bools, Bools]:
        """Everything that is locked: (N,) and (M,) bool."""
        none = np.zeros(len(mesh.points), bool), np.zeros(len(mesh.elements), bool)
        nodes: Bools = np.logical_or.reduce([none[0], *self.nodes.values()])
        elements: Bools = np.logical_or.reduce([none[1], *self.elements.values()])
        return nodes, elements

    def told(self, mesh: ShellMesh) -> list[Lock]:
        """Say each reason, with what it locks of the mesh."""
        found = [lock_of("nodes", mesh.node_ids[m], cards) for cards, m in self.nodes.items()]
        found += [
            lock_of("elements", mesh.element_ids[m], cards) for cards, m in self.elements.items()
        ]
        return [lock for lock in found if lock.count]


def find_locks(
    mesh: ShellMesh,
    uses: Uses,
    facts: ElementFacts,
    attributes: NodeAttributes,
    common: SharedMemberships,
    nsets: NamedSets,
    elsets: NamedSets,
    in_elsets: Mapping[str, Bools],
) -> Locks:
    """Collect what locks the nodes and elements of a mesh.

    Parameters
    ----------
    in_elsets : mapping of str to (M,) bool
        Elements of each set, by its identity.
    """
    found = Locks()
    for title, ids in uses.nodes.items():
        found.nodes[title] = ids.mask(mesh.node_ids)
    for title, nodes in facts.nodes.items():
        found.nodes[title] = np.isin(mesh.node_ids, list(nodes))
    found.nodes |= attributes.locked
    found.nodes |= _held(mesh, attributes, common)
    for title, ids in uses.elements.items():
        found.elements[title] = ids.mask(mesh.element_ids)
    found.elements |= facts.elements
    found.elements |= _without_births(mesh, attributes, common)
    # the nodes of a set of elements are a set to which each new one there would belong
    derived = {name for item in nsets if item.identity in attributes.apart for name in item.elsets}
    for item in elsets:
        if item.name == "LOCKED" or item.name in derived:
            found.elements[f"ELSET {item.name}"] = in_elsets[item.identity]
    return found


def _held(
    mesh: ShellMesh, attributes: NodeAttributes, common: SharedMemberships
) -> dict[str, Bools]:
    """Nodes that have more than their elements share, by what they have."""
    found: dict[str, Bools] = defaultdict(lambda: np.zeros(len(mesh.points), bool))
    locked = common.locked_nodes.tolist()
    for corners, region in zip(mesh.elements.tolist(), common.region.tolist(), strict=True):
        for node in corners:
            if node == NO_NODE or not locked[node]:
                continue
            mine = attributes.memberships[node]
            for item in mine:
                if item not in common.shared[region] or not item.can_shrink:
                    found[attributes.cards[item]][node] = True
    return dict(found)


def _without_births(
    mesh: ShellMesh, attributes: NodeAttributes, common: SharedMemberships
) -> dict[str, Bools]:
    """Elements in which no node may be born, by what a new one would have to have."""
    found: dict[str, Bools] = defaultdict(lambda: np.zeros(len(mesh.elements), bool))
    for row in np.flatnonzero(common.locked_elements).tolist():
        sets = [attributes.memberships[node] for node in mesh.elements[row] if node != NO_NODE]
        kinds = set.intersection(*({item.kind for item in mine} for mine in sets))
        shared = frozenset.intersection(*sets)
        for item in sets[0]:
            differs = item.kind in kinds and item not in shared
            if differs or (item in shared and not item.can_grow):
                how = "different values of " if differs else ""
                found[how + attributes.cards[item]][row] = True
    return dict(found)
