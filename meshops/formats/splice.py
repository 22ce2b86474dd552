"""Splicing: a deck written again with some lines replaced and all others byte for byte."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path, PurePosixPath, PureWindowsPath

from meshops.formats.output import refuse_to_overwrite, write_files
from meshops.formats.sources import Sources, locate

IncludeLines = Callable[[Sequence[str], str], list[str]]
"""Writes the lines of an include statement again with another path."""


class Splice:
    """Collects changes to the lines of a deck's stream, then writes the deck.

    Lines are named by their position in ``Sources.stream``; new text comes without line ends and
    takes the line end of its neighbour.
    """

    def __init__(self, sources: Sources) -> None:
        self._sources = sources
        self._replaced: list[dict[int, str]] = [{} for _ in sources.files]
        self._inserted: list[dict[int, str]] = [{} for _ in sources.files]

    def drop(self, lines: Iterable[int]) -> None:
        """Leave these lines out."""
        for position in lines:
            file, line = self._sources.places[position]
            self._replaced[file][line] = ""

    def replace(self, lines: Sequence[int], text: Iterable[str]) -> None:
        """Put ``text`` in the place of the first of these lines and drop the others."""
        self.drop(lines)
        file, line = self._sources.places[lines[0]]
        eol = _eol(self._sources.files[file].lines[line]) or self._file_eol(file)
        self._replaced[file][line] = "".join(row + eol for row in text)

    def insert_after(self, position: int, text: Iterable[str]) -> None:
        """Put ``text`` after this line, and after what was inserted there before."""
        file, line = self._sources.places[position]
        eol = self._file_eol(file)
        rows = "".join(row + eol for row in text)
        if rows:
            self._inserted[file][line] = self._inserted[file].get(line, "") + rows

    def write(self, path: Path, include_lines: IncludeLines) -> tuple[Path, ...]:
        """Write the deck to ``path`` and, beside it, the included files that it needs.

        An included file with a relative path inside the deck's folder keeps that path in the folder
        of ``path``. Any other is left where it is, or written beside ``path`` where it changes; its
        include statement is then made again by ``include_lines``. No file of the source deck and
        no file of other content is overwritten, except ``path``.

        Returns the files that were written, ``path`` first.

        Raises
        ------
        InputError
            Where ``path`` is a file of the source deck or cannot be written.
        """
        refuse_to_overwrite(path, [file.path for file in self._sources.files])
        path = path.resolve()
        destinations = self._destinations(path)
        self._redirect_includes(destinations, include_lines)
        contents = {
            place: self._render(number)
            for number, place in enumerate(destinations)
            if place != self._sources.files[number].path
        }
        write_files(contents)
        return tuple(contents)

    def _is_changed(self, number: int) -> bool:
        return bool(self._replaced[number] or self._inserted[number])

    def _render(self, number: int) -> bytes:
        lines = self._sources.files[number].lines
        replaced, inserted = self._replaced[number], self._inserted[number]
        if not self._is_changed(number):
            return "".join(lines).encode("latin-1")
        rows: list[str] = []
        for i, line in enumerate(lines):
            row = replaced.get(i, line)
            extra = inserted.get(i)
            if extra is not None:
                row += (self._file_eol(number) if row and not _eol(row) else "") + extra
            rows.append(row)
        return "".join(rows).encode("latin-1")

    def _file_eol(self, number: int) -> str:
        lines = self._sources.files[number].lines
        return (_eol(lines[0]) if lines else "") or "\n"

    def _destinations(self, path: Path) -> list[Path]:
        """(files,) where each file of the deck goes; its own path where it stays."""
        files = self._sources.files
        portable = self._portable()
        changed = {number for number in range(len(files)) if self._is_changed(number)}
        while True:
            places = self._place(path, portable, changed)
            # a file that stays cannot lead to one that goes: it has to change and go too
            stale = {
                number
                for number, file in enumerate(files)
                if places[number] == file.path
                and any(places[i.target] != files[i.target].path for i in file.includes)
            }
            if stale <= changed:
                return places
            changed |= stale

    def _place(self, path: Path, portable: set[int], changed: set[int]) -> list[Path]:
        files = self._sources.files
        folder = files[0].path.parent
        sources = {file.path for file in files}
        taken = sources | {path}
        places = [path]
        for number, file in enumerate(files[1:], start=1):
            inside = path.parent / file.path.relative_to(folder) if number in portable else None
            if number not in changed and (inside is None or inside == file.path):
                places.append(file.path)
                continue
            place = inside or path.parent / file.path.name
            if place in taken or not self._may_be_written(place, number):
                place = _own_name(path, file.path.name, taken)
            taken.add(place)
            places.append(place)
        return places

    def _may_be_written(self, place: Path, number: int) -> bool:
        return not place.exists() or (
            place.is_file() and place.read_bytes() == self._render(number)
        )

    def _portable(self) -> set[int]:
        """Numbers of the included files that are reached by relative paths inside the folder."""
        files = self._sources.files
        folder = files[0].path.parent
        portable = {0}
        for number, file in enumerate(files):
            if number not in portable:
                continue
            portable |= {
                include.target
                for include in file.includes
                if not _is_absolute(include.statement.written)
                and files[include.target].path.is_relative_to(folder)
            }
        return portable

    def _redirect_includes(self, places: list[Path], include_lines: IncludeLines) -> None:
        files = self._sources.files
        for number, file in enumerate(files):
            if places[number] == file.path:
                continue
            folder = places[number].parent
            for statement, target in file.includes:
                if locate(folder, statement.written) == places[target]:
                    continue
                stays = places[target] == files[target].path
                new = str(places[target]) if stays else os.path.relpath(places[target], folder)
                eol = self._file_eol(number)
                span = range(statement.first, statement.stop)
                rows = include_lines([file.lines[line] for line in span], new)
                self._replaced[number] |= dict.fromkeys(span, "")
                self._replaced[number][statement.first] = "".join(row + eol for row in rows)


def _own_name(path: Path, name: str, taken: set[Path]) -> Path:
    """Make a name that can only belong to the deck ``path``."""
    candidate = path.with_name(f"{path.stem}_{name}")
    count = 2
    while candidate in taken:
        candidate = path.with_name(f"{path.stem}_{count}_{name}")
        count += 1
    return candidate


def _is_absolute(written: str) -> bool:
    return PurePosixPath(written).is_absolute() or PureWindowsPath(written).is_absolute()


def _eol(line: str) -> str:
    return line[len(line.rstrip("\r\n")) :]
