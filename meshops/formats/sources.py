"""The text files of a deck, read in the order in which the solver reads them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from meshops.errors import InputError


class Statement(NamedTuple):
    """An include statement: its lines ``first`` to ``stop`` (exclusive) and the path it names.

    ``stays`` where the lines say more than that and are followed by what they include.
    """

    first: int
    stop: int
    written: str
    stays: bool = False


class Include(NamedTuple):
    """A statement together with the number of the file that it leads to."""

    statement: Statement
    target: int


FindIncludes = Callable[[Sequence[str]], list[Statement]]


@dataclass(frozen=True)
class SourceFile:
    """One file: its resolved path, its lines with their line ends, its includes.

    Bytes are decoded as latin-1, which gives every byte back on writing.
    """

    path: Path
    lines: list[str]
    includes: list[Include] = field(default_factory=list)


@dataclass(frozen=True)
class Sources:
    """All files of a deck and their lines in one stream.

    Attributes
    ----------
    files : list of SourceFile
        The deck itself comes first; a file that is included twice is in it once.
    stream : list of str
        The lines as the solver sees them: include statements replaced by what they include.
    places : list of (file, line)
        Where each line of the stream comes from, both counted from 0.
    """

    files: list[SourceFile] = field(default_factory=list)
    stream: list[str] = field(default_factory=list)
    places: list[tuple[int, int]] = field(default_factory=list)

    @property
    def name(self) -> str:
        """File name of the deck, for messages."""
        return self.files[0].path.name

    def where(self, position: int) -> str:
        """'name, line n' of a line of the stream, for messages."""
        file, line = self.places[position]
        return f"{self.files[file].path.name}, line {line + 1}"


def read_bytes(path: Path) -> bytes:
    """Read a file whole; raises InputError where it is missing, a folder or unreadable."""
    if path.is_dir():
        raise InputError(f"{path} is a folder: name the mesh file in it.")
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path} does not exist: check the name.") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}.") from error


def read_lines(path: Path) -> list[str]:
    """Lines of a text file with their line ends; raises InputError where it is not text."""
    data = read_bytes(path)
    if b"\0" in data:
        raise InputError(f"{path} is not a text file: check that it is the deck.")
    # str.splitlines would also split at form feeds and at latin-1's \x85
    return [line.decode("latin-1") for line in data.splitlines(keepends=True)]


def read_sources(path: Path, find_includes: FindIncludes) -> Sources:
    """Read a deck with everything that it includes.

    Paths in include statements are relative to the file that holds them.

    Raises
    ------
    InputError
        Where a file is missing, is not text, or includes itself.
    """
    sources = Sources()
    _visit(path.resolve(), sources, find_includes, parents=())
    return sources


def locate(folder: Path, written: str) -> Path:
    """Name the file that an include statement in a file of ``folder`` means."""
    return (folder / PurePosixPath(written.replace("\\", "/"))).resolve()


def _visit(
    path: Path, sources: Sources, find_includes: FindIncludes, parents: tuple[Path, ...]
) -> int:
    known = {file.path: number for number, file in enumerate(sources.files)}
    number = known.get(path, len(sources.files))
    again = path in known
    if not again:
        sources.files.append(SourceFile(path, read_lines(path)))
    file = sources.files[number]
    start = 0
    for statement in find_includes(file.lines):
        _append(sources, number, start, statement.stop if statement.stays else statement.first)
        start = statement.stop
        target = _included(file, statement, (*parents, path))
        child = _visit(target, sources, find_includes, (*parents, path))
        if not again:
            file.includes.append(Include(statement, child))
    _append(sources, number, start, len(file.lines))
    return number


def _included(file: SourceFile, statement: Statement, parents: tuple[Path, ...]) -> Path:
    target = locate(file.path.parent, statement.written)
    place = f"{file.path.name}, line {statement.first + 1}"
    if target in parents:
        raise InputError(f"{place}: '{statement.written}' includes itself; remove the statement.")
    if not target.is_file():
        raise InputError(
            f"{place}: the included file '{statement.written}' does not exist in "
            f"{file.path.parent}; put it there or correct the path."
        )
    return target


def _append(sources: Sources, number: int, start: int, stop: int) -> None:
    sources.stream.extend(sources.files[number].lines[start:stop])
    sources.places.extend((number, line) for line in range(start, stop))
