"""The decks that the benchmark of harm is run on: files, gmsh's structured meshes, made ones."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.gmsh_structured import GMSH_PARTS, gmsh_structured
from benchmarks.structured import structured
from meshops.formats import KNOWN, read_deck
from meshops.formats.verified import write_verified
from meshops.mesh import ShellMesh

SHARED = Path(__file__).resolve().parents[2] / "shared"


@dataclass(frozen=True)
class Source:
    """Where a deck comes from; travels to the process that works on it.

    Attributes
    ----------
    name : str
    path : Path or None
        The file, which is also written and read again.
    seed : int or None
        Of a structured deck.
    part : str or None
        One of ``GMSH_PARTS``.
    """

    name: str
    path: Path | None = None
    seed: int | None = None
    part: str | None = None

    def load(self) -> ShellMesh:
        """Read or make the mesh."""
        if self.path is not None:
            return read_deck(self.path).mesh
        if self.seed is not None:
            return structured(self.seed).mesh
        return gmsh_structured(self.part or "")

    def written(self, mesh: ShellMesh) -> ShellMesh:
        """Return what is read of the deck that is written with a mesh; itself without a file."""
        if self.path is None:
            return mesh
        found = [mesh]

        def keep(_: ShellMesh, again: ShellMesh) -> tuple[str, ...]:
            found.append(again)
            return ()

        with TemporaryDirectory() as folder:
            path = Path(folder) / self.path.name
            write_verified(read_deck(self.path), mesh, path, keep, read_deck)
        return found[-1]

    @property
    def planted(self) -> int:
        """Faults that were put in."""
        return structured(self.seed).planted if self.seed is not None else 0


def of_files(folder: Path) -> Iterator[Source]:
    """All files of a folder that may be decks: by their suffix."""
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.suffix.lower() in KNOWN:
            yield Source(str(path.relative_to(folder.parent)), path=path)


def of_gmsh(_: argparse.Namespace) -> Iterator[Source]:
    """Transfinite and graded meshes of gmsh."""
    for name in GMSH_PARTS:
        yield Source(f"gmsh {name}", part=name)


def of_seeds(options: argparse.Namespace) -> Iterator[Source]:
    """Make the structured decks of the first seeds."""
    for seed in range(options.seeds):
        yield Source(structured(seed).name, seed=seed)


GROUPS: dict[str, Callable[[argparse.Namespace], Iterator[Source]]] = {
    "shared": lambda options: of_files(options.shared / "data"),
    "faults": lambda options: of_files(options.shared / "faults"),
    "gmsh": of_gmsh,
    "structured": of_seeds,
}
"""What the command line calls them."""
