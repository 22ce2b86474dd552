"""What the nodes of an Abaqus deck have, and how it is written for new ones.

A node has facts (a support, a temperature: what data lines say of it or of a set that it is in) and
places in sets. Facts, and places in sets that a keyword uses as a whole, part the mesh: what the
nodes of an element share is had by a node that is born in it (``node_attributes``). All other sets
are followed where they can be: a new node joins where all nodes around it are members.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from meshops.formats.abaqus_scopes import Scope
from meshops.formats.abaqus_sets import NamedSet, NamedSets
from meshops.formats.abaqus_uses import Policy, Row, Uses, cards_of
from meshops.formats.ids import is_id
from meshops.formats.node_attributes import (
    Membership,
    Memberships,
    memberships_of_new_nodes,
    take_over_ids,
)
from meshops.formats.places import find_places
from meshops.formats.splice import Splice
from meshops.mesh import NEW, NO_NODE, Bools, Ids, ShellMesh


class Place(NamedTuple):
    """A place in the set of an identity."""

    identity: str


@dataclass(eq=False)
class NodeAttributes:
    """Facts and places of the nodes of a mesh.

    Attributes
    ----------
    memberships : list of N frozensets of Membership
        What parts the mesh; the kind of a membership is a ``Place`` or that of a fact.
    rows : dict of Membership to list of Row
        The data lines that give a fact.
    templates : dict of Membership to (Row, str)
        A line like which another can be written, and the instance that stands before its ids.
    brought : dict of str to frozenset of Membership
        What a place in a set brings with it, by the identity of the set.
    inside : dict of str to set of str
        Identities of the sets that a set takes in.
    followed : dict of str to (N,) bool
        Members of the sets that part nothing and that new nodes may join.
    locked : dict of str to (N,) bool
        Nodes that stay, by what keeps them.
    apart : set of str
        Identities of the sets that new nodes must not join.
    cards : dict of Membership to str
        What gives it, for a reader.
    """

    memberships: list[Memberships]
    rows: dict[Membership, list[Row]] = field(default_factory=dict)
    templates: dict[Membership, tuple[Row, str]] = field(default_factory=dict)
    brought: dict[str, Memberships] = field(default_factory=dict)
    inside: dict[str, set[str]] = field(default_factory=dict)
    followed: dict[str, Bools] = field(default_factory=dict)
    locked: dict[str, Bools] = field(default_factory=dict)
    apart: set[str] = field(default_factory=set)
    cards: dict[Membership, str] = field(default_factory=dict)


def node_attributes(
    mesh: ShellMesh, sets: NamedSets, members: Mapping[str, Bools], uses: Uses, scope: Scope
) -> NodeAttributes:
    """Find what each node has.

    Parameters
    ----------
    members : mapping of str to (N,) bool
        Of each set, by its identity.
    """
    found = NodeAttributes([])
    found.inside = {
        item.identity: {other.identity for other in sets.within(item)} - {item.identity}
        for item in sets
    }
    own: list[set[Membership]] = [set() for _ in mesh.node_ids]
    brought = _read_facts(found, own, mesh, sets, members, uses.node_rows, scope)
    for item in sets:
        policies = _policies(item, uses, scope)
        mask = members[item.identity]
        if item.name == "LOCKED" or "apart" in policies:
            _lock(found, item, mask)
        if policies & {"shared", "unknown"}:
            grows = policies <= {"shared", "output"}
            place = Membership(Place(item.identity), can_grow=grows, can_shrink=grows)
            found.cards[place] = f"NSET {item.name}"
            for row in np.flatnonzero(mask).tolist():
                own[row].add(place)
            for name in found.inside[item.identity]:
                brought[name].add(place)
        elif "output" in policies:
            _lock(found, item, mask & ~_in_areas(mesh, mask))
        if "apart" in policies:
            found.apart |= {item.identity, *found.inside[item.identity]}
    hard = _places(found)
    found.followed = {
        item.identity: members[item.identity]
        for item in sets
        if item.identity not in found.apart and Place(item.identity) not in hard
    }
    found.brought = {name: frozenset(mine) for name, mine in brought.items()}
    found.memberships = [frozenset(mine) for mine in own]
    return found


def _lock(found: NodeAttributes, item: NamedSet, mask: Bools) -> None:
    name = f"NSET {item.name}"
    found.locked[name] = found.locked[name] | mask if name in found.locked else mask


def _places(found: NodeAttributes) -> set[Hashable]:
    return {item.kind for item in found.cards if isinstance(item.kind, Place)}


def _read_facts(
    found: NodeAttributes,
    own: Sequence[set[Membership]],
    mesh: ShellMesh,
    sets: NamedSets,
    members: Mapping[str, Bools],
    rows: Iterable[Row],
    scope: Scope,
) -> dict[str, set[Membership]]:
    """Give each node the last fact of each kind that the rows tell of it.

    Returns
    -------
    dict of str to set of Membership
        The facts that each set brings, by its identity.
    """
    row_of_node = {node: row for row, node in enumerate(mesh.node_ids.tolist())}
    latest: list[dict[Hashable, Membership]] = [{} for _ in own]
    in_sets: dict[str, dict[Hashable, Membership]] = defaultdict(dict)
    for row in rows:
        fact = Membership(row.fact.kind, row.fact.value)
        found.rows.setdefault(fact, []).append(row)
        found.cards.setdefault(fact, cards_of(row))
        if is_id(row.subject):
            found.templates[fact] = (row, row.instance)
            subjects = [row_of_node[int(row.subject)]] if int(row.subject) in row_of_node else []
        else:
            named = [item for item in sets if _means(scope, row, item)]
            subjects = [
                i for item in named for i in np.flatnonzero(members[item.identity]).tolist()
            ]
            for item in (other for parent in named for other in sets.within(parent)):
                in_sets[item.identity][fact.kind] = fact
                found.templates.setdefault(fact, (row, row.instance or item.instance))
        for i in subjects:
            latest[i][fact.kind] = fact
    for mine, facts in zip(own, latest, strict=True):
        mine.update(facts.values())
    brought: dict[str, set[Membership]] = defaultdict(set)
    brought |= {name: set(facts.values()) for name, facts in in_sets.items()}
    return brought


def _means(scope: Scope, row: Row, item: NamedSet) -> bool:
    return scope.means(row.token, row.block, scope=item.scope, name=item.name)


def _policies(item: NamedSet, uses: Uses, scope: Scope) -> set[Policy]:
    """How keywords use a set."""
    return {
        use.policy
        for use in uses.set_uses
        if scope.means(use.token, use.block, scope=item.scope, name=item.name)
    }


def _in_areas(mesh: ShellMesh, members: Bools) -> Bools:
    """Members of elements that have only members; the others are points and lines of a set."""
    corners = np.where(mesh.elements == NO_NODE, mesh.elements[:, :1], mesh.elements)
    found = np.zeros(len(members), bool)
    found[corners[members[corners].all(axis=1)]] = True
    return found


# --- writing ----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class NewNodes:
    """What is written for the new nodes of an edited mesh.

    Attributes
    ----------
    joining : dict of str to list of int
        Ids by the identity of the set that they join.
    facts : dict of Membership to list of int
        Ids by the fact that no set brings them.
    """

    joining: dict[str, list[int]]
    facts: dict[Membership, list[int]]


def new_nodes(
    attributes: NodeAttributes,
    got: Mapping[int, Memberships],
    followed: Mapping[int, frozenset[str]],
    node_ids: Ids,
) -> NewNodes:
    """Decide which sets the new nodes join and which facts they need lines for.

    Parameters
    ----------
    got
        What the region of each new node gives it, by its row.
    followed
        Identities of the followed sets that all nodes around it are in.
    """
    joining: dict[str, list[int]] = defaultdict(list)
    facts: dict[Membership, list[int]] = defaultdict(list)
    for row, mine in sorted(got.items()):
        node = int(node_ids[row])
        places = {item.kind.identity for item in mine if isinstance(item.kind, Place)}
        joined = places | {
            name
            for name in followed.get(row, frozenset())
            if attributes.brought.get(name, frozenset()) <= mine
        }
        lacking = {item for item in mine if not isinstance(item.kind, Place)}
        lacking -= _brought(attributes, joined)
        # a set of no other meaning brings a fact in fewer lines than a line for each node
        for name, brought in attributes.brought.items():
            if name in attributes.followed and brought & lacking and brought <= mine:
                joined.add(name)
                lacking -= brought
        # who is in a set is in all that take it in
        joined = {name for name in joined if not attributes.inside[name] & joined}
        for name in joined:
            joining[name].append(node)
        for fact in lacking:
            facts[fact].append(node)
    return NewNodes(joining, facts)


def with_old_ids(
    before: ShellMesh,
    after: ShellMesh,
    attributes: NodeAttributes,
    shared: Sequence[Memberships],
) -> ShellMesh:
    """Give new nodes the ids of vanished ones that were in the same sets: these need not change."""
    places = {name: Membership(Place(name)) for name in attributes.followed}
    own = [set(mine) for mine in attributes.memberships]
    of_region = [set(mine) for mine in shared]
    corners = np.where(before.elements == NO_NODE, before.elements[:, :1], before.elements)
    for name, mask in attributes.followed.items():
        for row in np.flatnonzero(mask).tolist():
            own[row].add(places[name])
        has_others = np.zeros(len(shared), bool)
        has_others[before.region[~mask[corners].all(axis=1)]] = True
        for region in np.flatnonzero(~has_others).tolist():
            of_region[region].add(places[name])
    every = [frozenset(mine) for mine in of_region]
    found = take_over_ids(before, after, [frozenset(mine) for mine in own], every, bool)
    followed = followed_by_new_nodes(after, before, attributes.followed)
    node_ids = found.node_ids.copy()
    for row, mine in memberships_of_new_nodes(after, every).items():
        if {places[name] for name in followed.get(row, ())} - mine:
            node_ids[row] = NEW
    node_ids.setflags(write=False)
    return replace(found, node_ids=node_ids)


def followed_by_new_nodes(
    mesh: ShellMesh, before: ShellMesh, followed: Mapping[str, Bools]
) -> dict[int, frozenset[str]]:
    """Find for each new node of an edited mesh the sets that all nodes around it were in, by row.

    Those are the nodes of the element of the mesh before that holds the place of the new one.
    """
    if not followed:
        return {}
    corners = np.where(before.elements == NO_NODE, before.elements[:, :1], before.elements)
    inside = {name: np.all(mask[corners], axis=1) for name, mask in followed.items()}
    found: dict[int, frozenset[str]] = {}
    for region in np.unique(mesh.region).tolist():
        nodes = np.unique(mesh.elements[mesh.region == region])
        new = nodes[(nodes != NO_NODE) & (mesh.node_ids[nodes] == NEW)]
        if not len(new):
            continue
        rows = np.flatnonzero(before.region == region)
        place = rows[find_places(before, rows, mesh.points[new])[0]]
        for node, row in zip(new.tolist(), place.tolist(), strict=True):
            found[node] = frozenset(name for name, mask in inside.items() if mask[row])
    return found


def write_facts(
    splice: Splice,
    lines: Sequence[str],
    attributes: NodeAttributes,
    new: NewNodes,
    gone: Iterable[int],
) -> None:
    """Take the lines of vanished nodes out, and give lines to the new ones that need them."""
    vanished = set(gone)
    for rows in attributes.rows.values():
        for row in rows:
            if is_id(row.subject) and int(row.subject) in vanished:
                splice.drop([row.position])
    for fact, nodes in sorted(new.facts.items(), key=repr):
        row, instance = attributes.templates[fact]
        line = lines[row.position].rstrip("\r\n")
        texts = (line.replace(row.token, f"{instance}{node}", 1) for node in nodes)
        splice.insert_after(row.position, texts)


def _brought(attributes: NodeAttributes, names: Iterable[str]) -> set[Membership]:
    return {fact for name in names for fact in attributes.brought.get(name, ())}
