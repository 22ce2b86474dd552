"""Topology: who sends migrants to whom."""

from __future__ import annotations

from dataclasses import dataclass
from math import isqrt
from typing import Any, Literal

from meshops.errors import InputError

TopologyKind = Literal[
    "unconnected",
    "ring",
    "two-way-ring",
    "torus",
    "star",
    "hypercube",
    "fully-connected",
    "small-world",
    "random-regular",
    "edges",
]

Link = tuple[int, int]
"""Source and target."""

MOST_LINKS = 250_000
"""More of them take longer to make than a run of theirs would."""

TRIES = 100
"""Random graphs that are drawn until one is connected."""


@dataclass(frozen=True)
class Topology:
    """A graph of islands.

    Attributes
    ----------
    kind : str
        ``ring`` goes one way, to the next island; ``edges`` are the user's; all others go both
        ways. The middle of a ``star`` is island 0, and the sides of a ``torus`` are as equal as the
        number of islands allows.
    degree : int
        Neighbours of each island in ``small-world`` (Watts and Strogatz 1998) and
        ``random-regular``.
    rewiring : float
        Share of the links of a ``small-world`` that lead elsewhere than to the next islands.
    edges : tuple of (int, int)
        Source and target of each link of ``edges``.
    seed : int
        Of the two random ones.
    """

    kind: TopologyKind = "ring"
    degree: int = 4
    rewiring: float = 0.1
    edges: tuple[Link, ...] = ()
    seed: int = 1

    def links(self, islands: int) -> tuple[Link, ...]:
        """All (source, target) among so many islands, by source and then target.

        Raises InputError where there is no such graph of so many islands.
        """
        if self.kind == "edges":
            return self._own_edges(islands)
        if islands < 2 or self.kind == "unconnected":
            return ()
        if self.kind == "ring":
            return tuple((island, (island + 1) % islands) for island in range(islands))
        self._check_number(islands)
        found = self._graph(islands).edges
        return tuple(sorted({(a, b) for a, b in found} | {(b, a) for a, b in found}))

    def _check_number(self, islands: int) -> None:
        neighbours = {
            "fully-connected": islands - 1,
            "small-world": self.degree,
            "random-regular": self.degree,
        }
        if islands * neighbours.get(self.kind, 1) > MOST_LINKS:
            raise InputError(
                f"{islands} islands have more than {MOST_LINKS:,} links in a {self.kind} topology; "
                "take fewer islands or another topology."
            )

    def _own_edges(self, islands: int) -> tuple[Link, ...]:
        for source, target in self.edges:
            if source == target or not (0 <= source < islands and 0 <= target < islands):
                raise InputError(
                    f"the link from island {source} to {target} does not fit {islands} islands, "
                    f"which have the numbers 0 to {islands - 1} and send nothing to themselves."
                )
        return tuple(sorted(set(self.edges)))

    def _graph(self, islands: int) -> Any:
        """Undirected graph, nodes from 0."""
        import networkx as nx

        if self.kind == "two-way-ring":
            return nx.cycle_graph(islands)
        if self.kind == "star":
            return nx.star_graph(islands - 1)
        if self.kind == "fully-connected":
            return nx.complete_graph(islands)
        if self.kind == "torus":
            rows = max(n for n in range(1, isqrt(islands) + 1) if islands % n == 0)
            grid = nx.grid_2d_graph(rows, islands // rows, periodic=True)
            grid.remove_edges_from(list(nx.selfloop_edges(grid)))
            return nx.convert_node_labels_to_integers(grid, ordering="sorted")
        if self.kind == "hypercube":
            if islands & (islands - 1):
                raise InputError(f"a hypercube has 2, 4, 8, … islands and not {islands}.")
            cube = nx.hypercube_graph(islands.bit_length() - 1)
            return nx.convert_node_labels_to_integers(cube, ordering="sorted")
        return self._random_graph(nx, islands)

    def _random_graph(self, nx: Any, islands: int) -> Any:
        least = 1 if islands == 2 else 2
        if not least <= self.degree < islands:
            raise InputError(
                f"{islands} islands can have {least} to {islands - 1} neighbours each in a "
                f"{self.kind} topology, not {self.degree}."
            )
        if self.kind == "small-world":
            return nx.connected_watts_strogatz_graph(
                islands, self.degree, self.rewiring, tries=TRIES, seed=self.seed
            )
        if self.degree * islands % 2:
            raise InputError(
                f"{islands} islands cannot have {self.degree} neighbours each: one of the two "
                "numbers must be even."
            )
        for seed in range(self.seed, self.seed + TRIES):
            graph = _random_regular(nx, self.degree, islands, seed)
            if nx.is_connected(graph):
                return graph
        raise InputError(
            f"no connected graph of {islands} islands with {self.degree} neighbours each was "
            f"found in {TRIES} tries; give more neighbours."
        )


def _random_regular(nx: Any, degree: int, islands: int, seed: int) -> Any:
    """Draw a graph; a dense one as what a sparse one leaves: drawing it itself need not end."""
    if 2 * degree < islands:
        return nx.random_regular_graph(degree, islands, seed=seed)
    return nx.complement(nx.random_regular_graph(islands - 1 - degree, islands, seed=seed))
