"""Parts, instances and the assembly: which of them a block or a name speaks of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from meshops.formats.abaqus_blocks import Block, name_key, without_instance
from meshops.formats.ids import is_id

_OUTSIDE = ("", "ASSEMBLY")


@dataclass(frozen=True)
class Scope:
    """A part, an instance with nodes of its own, or all that stands outside of these.

    Attributes
    ----------
    name : str
        'PART X', 'INSTANCE X' or ''.
    instances, others : frozenset of str
        Names of the instances of it, and of all others.
    """

    name: str
    instances: frozenset[str] = frozenset()
    others: frozenset[str] = frozenset()

    @classmethod
    def of(cls, name: str, every: Sequence[Block]) -> Scope:
        """Find the instances of a scope among the blocks of a deck."""
        parts = {
            block.parameters.get("NAME", ""): block.parameters.get("PART", "")
            for block in every
            if block.keyword == "INSTANCE"
        }
        mine = frozenset(
            instance
            for instance, part in parts.items()
            if name in (f"PART {part}", f"INSTANCE {instance}")
        )
        return cls(name, mine, frozenset(parts) - mine)

    def is_spoken_of(self, block: Block) -> bool:
        """Tell whether ids in a block are those of the scope: other parts count their own."""
        if block.scope == self.name:
            return True
        if block.scope not in _OUTSIDE:
            return False
        return block.parameters.get("INSTANCE", "") not in self.others

    def own(self, token: str) -> tuple[str, str] | None:
        """Part 'I1.17' into 'I1.' and '17'; None where it speaks of another part."""
        before, text = without_instance(token)
        instance = name_key(before[:-1])
        if instance in self.others:
            return None
        if before and not is_id(text) and instance not in self.instances:
            return "", token.strip()
        return before, text

    def means(self, token: str, block: Block, *, scope: str, name: str) -> bool:
        """Tell whether a token in a block means the set of a name that stands in a scope."""
        parted = self.own(token)
        if parted is None or name_key(parted[1]) != name:
            return False
        if parted[0]:
            return scope == self.name
        return block.scope == scope or (block.scope in _OUTSIDE and scope in _OUTSIDE)
