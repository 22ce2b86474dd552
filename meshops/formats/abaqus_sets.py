"""The named sets of an Abaqus deck: who is in them, and how they are kept in step with the mesh."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from meshops.formats.abaqus_blocks import (
    Block,
    fields,
    generated_range,
    id_list,
    name_key,
    without_instance,
)
from meshops.formats.abaqus_output import generated_rows, set_rows
from meshops.formats.ids import IdSet, is_id
from meshops.formats.splice import Splice
from meshops.mesh import Bools, Ids


@dataclass(eq=False)
class NamedSet:
    """A set of nodes or of elements.

    Attributes
    ----------
    identity : str
        Scope, instance and name: sets of one name in different scopes are different sets.
    scope : str
        Of its blocks.
    name : str
        Its key.
    lists : list of Block
        The *NSET or *ELSET blocks that list its members.
    headers : list of Block
        The *NODE or *ELEMENT blocks that put all that they define into it.
    numbers : IdSet
        Members that are named by number, in lists or under the headers.
    children : set of str
        Keys of the sets that it takes in whole.
    elsets : set of str
        Keys of the sets of elements whose nodes it takes in.
    """

    identity: str
    scope: str
    name: str
    lists: list[Block] = field(default_factory=list)
    headers: list[Block] = field(default_factory=list)
    numbers: IdSet = field(default_factory=IdSet)
    children: set[str] = field(default_factory=set)
    elsets: set[str] = field(default_factory=set)

    @property
    def instance(self) -> str:
        """'I1.' where its lists count nodes or elements of an instance, else ''."""
        written = next((b.written["INSTANCE"] for b in self.lists if "INSTANCE" in b.written), "")
        return f"{written}." if written else ""


class NamedSets:
    """The sets of one kind, 'NSET' or 'ELSET', that speak of one part."""

    def __init__(self, kind: str, blocks: Iterable[Block], lines: Sequence[str]) -> None:
        self.kind = kind
        self._lines = lines
        self._sets: dict[str, NamedSet] = {}
        home = {"NSET": "NODE", "ELSET": "ELEMENT"}[kind]
        for block in blocks:
            if block.keyword == kind and block.parameters.get(kind):
                self._read_list(block)
            elif block.keyword == home and block.parameters.get(kind):
                self._of(block).headers.append(block)

    def __iter__(self) -> Iterator[NamedSet]:
        return iter(self._sets.values())

    def _of(self, block: Block) -> NamedSet:
        identity = identity_of(self.kind, block)
        new = NamedSet(identity, block.scope, block.parameters[self.kind])
        return self._sets.setdefault(identity, new)

    def _read_list(self, block: Block) -> None:
        found = self._of(block)
        if "ELSET" in block.parameters and self.kind == "NSET":
            found.elsets.add(block.parameters["ELSET"])
            found.lists.append(block)
            return
        found.lists.append(block)
        found.numbers.update(id_list(block, self._lines))
        for position in block.data:
            found.children |= {
                key
                for token in fields(self._lines[position])
                if token and not is_id(without_instance(token)[1])
                for key in keys_of(token)
            }

    def masks(
        self,
        ids: Ids,
        of_headers: Mapping[int, IdSet],
        of_elset: Mapping[str, Bools] | None = None,
    ) -> dict[str, Bools]:
        """Which of ``ids`` (N,) are in each set, by its identity: (N,) bool.

        Parameters
        ----------
        of_headers
            Ids under each header of a *NODE or *ELEMENT block, by its position.
        of_elset
            Nodes of the elements of a set, by its key.
        """
        own = {}
        for item in self:
            members = IdSet()
            members.update(item.numbers)
            for block in item.headers:
                members.update(of_headers.get(block.header[0], IdSet()))
            mask = members.mask(ids)
            for name in item.elsets:
                mask |= (of_elset or {}).get(name, False)
            own[item.identity] = mask
        return {item.identity: self._with_children(item, own) for item in self}

    def _with_children(self, item: NamedSet, own: Mapping[str, Bools]) -> Bools:
        mask: Bools = np.logical_or.reduce([own[other.identity] for other in self.within(item)])
        return mask

    def within(self, item: NamedSet) -> list[NamedSet]:
        """Find the set itself and all that it takes in, directly or not."""
        found = {item.identity: item}
        waiting = [item]
        while waiting:
            children = waiting.pop().children
            for other in self if children else ():
                if other.name in children and other.identity not in found:
                    found[other.identity] = other
                    waiting.append(other)
        return list(found.values())

    def write(
        self, splice: Splice, *, gone: Iterable[int], joining: Mapping[str, Sequence[int]]
    ) -> None:
        """Take what vanished out of all lists, and put what is new into the lists of its sets.

        Lines that lose nobody stay as they are, and new members come after them.

        Parameters
        ----------
        gone
            Ids.
        joining
            New ids by the identity of the set.
        """
        vanished = np.array(sorted(gone), np.int64)
        for item in self:
            growing = [block for block in item.lists if not _is_derived(block)]
            new = sorted(joining.get(item.identity, ()))
            for block in growing:
                self._write_list(splice, block, vanished, new if block is growing[-1] else [])
            if new and not growing and item.lists:
                last = item.lists[-1]
                splice.insert_after(last.last, [header_of(self.kind, last), *set_rows(_texts(new))])

    def _write_list(self, splice: Splice, block: Block, gone: Ids, new: Sequence[int]) -> None:
        keep = self._kept_range if block.is_generated else _kept_tokens
        empty = bool(block.data)
        for position in block.data:
            rows = keep(self._lines[position], gone)
            if rows is not None:
                splice.replace([position], rows)
            empty &= rows == []
        prefix = self._prefix(block)
        rows = (
            generated_rows(new, prefix)
            if block.is_generated
            else set_rows([f"{prefix}{number}" for number in new])
        )
        if rows:
            splice.insert_after(block.last, rows)
        elif empty and not any(block.parameters[self.kind] in item.children for item in self):
            splice.drop(block.header)

    def _kept_range(self, line: str, gone: Ids) -> list[str] | None:
        found = generated_range(line)
        members = IdSet(ranges={found} if found else set())
        leaving = gone[members.mask(gone)]
        if found is None or not len(leaving):
            return None
        first, last, step = found
        prefix = without_instance(fields(line)[0])[0]
        rows = []
        for leaver in [*leaving.tolist(), last + step]:
            if leaver > first:
                rows.append(f"{prefix}{first}, {prefix}{leaver - step}, {step}")
            first = leaver + step
        return rows

    def _prefix(self, block: Block) -> str:
        """Name the instance that stands before every number of a list."""
        tokens = [t for position in block.data for t in fields(self._lines[position]) if t]
        parted = [without_instance(token) for token in tokens]
        prefixes = {before for before, text in parted if is_id(text)}
        return prefixes.pop() if len(prefixes) == 1 else ""


def identity_of(kind: str, block: Block) -> str:
    """Scope, instance and name of the set that a block puts something into."""
    name = block.parameters.get(kind, "")
    return ":".join([block.scope, block.parameters.get("INSTANCE", ""), name])


def header_of(kind: str, block: Block) -> str:
    """Write the keyword line of a further list of the same set."""
    instance = block.written.get("INSTANCE")
    return f"*{kind}, {kind}={block.written[kind]}" + (f", INSTANCE={instance}" if instance else "")


def keys_of(token: str) -> tuple[str, ...]:
    """Keys that a token can mean: the whole of it, and what stands behind an instance."""
    return tuple(dict.fromkeys((name_key(token), name_key(without_instance(token)[1]))))


def _is_derived(block: Block) -> bool:
    return block.keyword == "NSET" and "ELSET" in block.parameters


def _kept_tokens(line: str, gone: Ids) -> list[str] | None:
    tokens = fields(line)
    numbers = [without_instance(token)[1] for token in tokens]
    ids = np.array([int(text) if is_id(text) else 0 for text in numbers], np.int64)
    leaving = np.isin(ids, gone) & (ids > 0)
    if not leaving.any():
        return None
    kept = [token for token, leaves in zip(tokens, leaving, strict=True) if token and not leaves]
    # a line that ends in a comma goes on
    return [", ".join(kept) + "," * (not tokens[-1])] if kept else []


def _texts(ids: Iterable[int]) -> list[str]:
    return [str(number) for number in ids]
