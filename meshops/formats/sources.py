"""The text files of a deck, read in the order in which the solver reads them."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Literal, NamedTuple

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
FindSymbols = Callable[[Sequence[str]], Mapping[str, str]]
Where = Literal["beside", "root"]

_BYTE_ORDER_MARK = "\xef\xbb\xbf"


@dataclass(frozen=True)
class Search:
    """Where an include statement looks for its file.

    Attributes
    ----------
    order : tuple of 'beside' and 'root'
        In the folder of the including file, and in that of the first one.
    symbols : dict of str to str
        Folders by their logical names, in capitals; the environment may define others.
    """

    order: tuple[Where, ...] = ("beside", "root")
    symbols: dict[str, str] = field(default_factory=dict)

    def candidates(self, written: str, *, beside: Path, root: Path) -> list[Path]:
        """Paths that a statement may mean, in the order in which they are tried."""
        symbol, rest = split_symbol(written)
        if not symbol:
            folders = {"beside": beside, "root": root}
            return [_join(folders[where], written) for where in self.order]
        folder = self._folder(symbol)
        if folder is not None:
            return [_join(_join(root, folder), rest)]
        return [_join(beside, rest), _join(root, rest)]

    def is_relative(self, written: str) -> bool:
        """Tell whether what a statement means depends on where the deck is."""
        symbol, rest = split_symbol(written)
        path = (self._folder(symbol) or rest) if symbol else written
        return not (PurePosixPath(path).is_absolute() or PureWindowsPath(path).is_absolute())

    def _folder(self, symbol: str) -> str | None:
        return self.symbols.get(symbol.upper(), os.environ.get(symbol))


def split_symbol(written: str) -> tuple[str, str]:
    """('SYM', 'file') of 'SYM:file'; the symbol is '' where there is none, as in 'C:/file'."""
    symbol, colon, rest = written.partition(":")
    is_symbol = bool(colon) and len(symbol) > 1 and symbol.isidentifier()
    return (symbol, rest.lstrip("/\\")) if is_symbol else ("", written)


@dataclass(frozen=True)
class SourceFile:
    """One file: its resolved path, its lines with their line ends, its includes.

    Bytes are decoded as latin-1, which gives every byte back on writing. A byte order mark stands
    before the first line and not in it.
    """

    path: Path
    lines: list[str]
    includes: list[Include] = field(default_factory=list)
    byte_order_mark: str = ""


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
    search : Search
    groups : list of list of int
        Positions of lines that stand for each other, as where a line says 'eight times the same'
        and the stream holds all eight: where one changes, all are written out.
    """

    files: list[SourceFile] = field(default_factory=list)
    stream: list[str] = field(default_factory=list)
    places: list[tuple[int, int]] = field(default_factory=list)
    search: Search = field(default_factory=Search)
    groups: list[list[int]] = field(default_factory=list)

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


def read_sources(
    path: Path,
    find_includes: FindIncludes,
    *,
    order: tuple[Where, ...] = ("beside", "root"),
    find_symbols: FindSymbols | None = None,
) -> Sources:
    """Read a deck with everything that it includes.

    Parameters
    ----------
    order
        Where an included file is looked for: beside the file that includes it, and in the folder
        of the deck.
    find_symbols
        Finds the logical names that the lines of a file define, in capitals.

    Raises
    ------
    InputError
        Where a file is missing, is not text, or includes itself.
    """
    sources = Sources(search=Search(order))
    _visit(path.resolve(), sources, find_includes, find_symbols, parents=())
    return sources


def _join(folder: Path, written: str) -> Path:
    return (folder / PurePosixPath(written.replace("\\", "/"))).resolve()


def _visit(
    path: Path,
    sources: Sources,
    find_includes: FindIncludes,
    find_symbols: FindSymbols | None,
    parents: tuple[Path, ...],
) -> int:
    known = {file.path: number for number, file in enumerate(sources.files)}
    number = known.get(path, len(sources.files))
    again = path in known
    if not again:
        sources.files.append(_read_file(path))
    file = sources.files[number]
    if find_symbols is not None:
        sources.search.symbols.update(find_symbols(file.lines))
    start = 0
    for statement in find_includes(file.lines):
        _append(sources, number, start, statement.stop if statement.stays else statement.first)
        start = statement.stop
        target = _included(sources, file, statement, (*parents, path))
        child = _visit(target, sources, find_includes, find_symbols, (*parents, path))
        if not again:
            file.includes.append(Include(statement, child))
    _append(sources, number, start, len(file.lines))
    return number


def _read_file(path: Path) -> SourceFile:
    lines = read_lines(path)
    mark = _BYTE_ORDER_MARK if lines and lines[0].startswith(_BYTE_ORDER_MARK) else ""
    if mark:
        lines[0] = lines[0].removeprefix(mark)
    return SourceFile(path, lines, byte_order_mark=mark)


def _included(
    sources: Sources, file: SourceFile, statement: Statement, parents: tuple[Path, ...]
) -> Path:
    beside, root = file.path.parent, sources.files[0].path.parent
    candidates = sources.search.candidates(statement.written, beside=beside, root=root)
    found = [path for path in candidates if path.is_file()]
    others = [path for path in found if path not in parents]
    place = f"{file.path.name}, line {statement.first + 1}"
    if found and not others:
        raise InputError(f"{place}: '{statement.written}' includes itself; remove the statement.")
    if not found:
        folders = " or ".join(dict.fromkeys(str(path.parent) for path in candidates))
        symbol = split_symbol(statement.written)[0]
        remedy = f"define {symbol} by an ASSIGN or in the environment" if symbol else "put it there"
        raise InputError(
            f"{place}: the included file '{statement.written}' does not exist in {folders}; "
            f"{remedy} or correct the path."
        )
    return others[0]


def _append(sources: Sources, number: int, start: int, stop: int) -> None:
    sources.stream.extend(sources.files[number].lines[start:stop])
    sources.places.extend((number, line) for line in range(start, stop))
