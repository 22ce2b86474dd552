"""Topology: who sends migrants to whom."""

from __future__ import annotations


def ring(islands: int) -> list[tuple[int, int]]:
    """One-way ring: pairs (source, target), each island to the next; none for a single island."""
    if islands < 2:
        return []
    return [(island, (island + 1) % islands) for island in range(islands)]
