"""Splicing: a deck written again with some lines replaced and all others byte for byte."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from meshops.formats.output import refuse_to_overwrite, write_files
from meshops.formats.sources import Sources, Statement

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
        self._group_of = {i: n for n, group in enumerate(sources.groups) for i in group}
        self._in_groups: dict[int, str] = {}

    def drop(self, lines: Iterable[int]) -> None:
        """Leave these lines out."""
        for position in lines:
            self._put(position, "")

    def replace(self, lines: Sequence[int], text: Iterable[str]) -> None:
        """Put ``text`` in the place of the first of these lines and drop the others."""
        self.drop(lines)
        file, line = self._sources.places[lines[0]]
        eol = _eol(self._sources.files[file].lines[line]) or self._file_eol(file)
        self._put(lines[0], "".join(row + eol for row in text))

    def _put(self, position: int, text: str) -> None:
        file, line = self._sources.places[position]
        if position in self._group_of:
            self._in_groups[position] = text
        else:
            self._replaced[file][line] = text

    def insert_after(self, position: int, text: Iterable[str]) -> None:
        """Put ``text`` after this line, and after what was inserted there before."""
        file, line = self._sources.places[position]
        eol = self._file_eol(file)
        rows = "".join(row + eol for row in text)
        if rows:
            self._inserted[file][line] = self._inserted[file].get(line, "") + rows

    def write(self, path: Path, include_lines: IncludeLines) -> None:
        """Write the deck to ``path`` and, beside it, the included files that it needs.

        An included file with a relative path inside the deck's folder keeps that path in the folder
        of ``path``. One outside of it is written below the folder of ``path``, in the folders that
        its path names, where it changes or where its path no longer leads to it; its include
        statement is then made again by ``include_lines``. One with an absolute path or a logical
        name is left where it is unless it changes. No file of the source deck and no file of
        other content is overwritten, except ``path``.

        Raises
        ------
        InputError
            Where ``path`` is a file of the source deck or cannot be written.
        """
        refuse_to_overwrite(path, [file.path for file in self._sources.files])
        path = path.resolve()
        self._write_out_groups()
        destinations, changed = self._destinations(path)
        self._redirect_includes(destinations, changed, include_lines)
        contents = {
            place: self._render(number)
            for number, place in enumerate(destinations)
            if place != self._sources.files[number].path
        }
        write_files(contents)

    def _write_out_groups(self) -> None:
        """Write all lines of each group of which one changes."""
        sources = self._sources
        for group in {self._group_of[position] for position in self._in_groups}:
            for file, line in {sources.places[position] for position in sources.groups[group]}:
                self._replaced[file][line] = ""
            for position in sources.groups[group]:
                file, line = sources.places[position]
                text = self._in_groups.get(position, sources.stream[position])
                self._replaced[file][line] += text

    def _is_changed(self, number: int) -> bool:
        return bool(self._replaced[number] or self._inserted[number])

    def _render(self, number: int) -> bytes:
        lines = self._sources.files[number].lines
        replaced, inserted = self._replaced[number], self._inserted[number]
        rows: list[str] = [self._sources.files[number].byte_order_mark]
        if not self._is_changed(number):
            return "".join([*rows, *lines]).encode("latin-1")
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

    def _destinations(self, path: Path) -> tuple[list[Path], set[int]]:
        """(files,) where each file goes, its own path where it stays; and which ones change."""
        files = self._sources.files
        changed = {number for number in range(len(files)) if self._is_changed(number)}
        while True:
            places = self._place(path, changed)
            # a file that stays cannot lead to one that goes: it has to change and go too
            stale = {
                number
                for number, file in enumerate(files)
                if places[number] == file.path
                and any(places[i.target] != files[i.target].path for i in file.includes)
            }
            if stale <= changed:
                return places, changed
            changed |= stale

    def _place(self, path: Path, changed: set[int]) -> list[Path]:
        files = self._sources.files
        folder = files[0].path.parent
        taken = {file.path for file in files} | {path}
        places = [path]
        for number, file in enumerate(files[1:], start=1):
            statements = self._relative_statements(number, places)
            inside = path.parent / _below(file.path, folder) if statements else None
            goes = number in changed or any(
                file.path.is_relative_to(folder)
                or self._lead(statement, place.parent, path.parent) != file.path
                for statement, place in statements
            )
            if not goes or (number not in changed and inside == file.path):
                places.append(file.path)
                continue
            place = inside or path.parent / file.path.name
            if place in taken or not self._may_be_written(place, number):
                place = _own_name(path, file.path.name, taken)
            taken.add(place)
            places.append(place)
        return places

    def _relative_statements(
        self, number: int, places: Sequence[Path]
    ) -> list[tuple[Statement, Path]]:
        """Statements that lead to a file by relative paths, and where their own files go."""
        return [
            (statement, place)
            for file, place in zip(self._sources.files, places, strict=False)
            for statement, target in file.includes
            if target == number and self._sources.search.is_relative(statement.written)
        ]

    def _lead(
        self, statement: Statement, beside: Path, root: Path, made: Sequence[Path] = ()
    ) -> Path | None:
        """Where a statement leads from other folders, where files of ``made`` will be."""
        candidates = self._sources.search.candidates(statement.written, beside=beside, root=root)
        return next((path for path in candidates if path in made or path.is_file()), None)

    def _may_be_written(self, place: Path, number: int) -> bool:
        return not place.exists() or (
            place.is_file() and place.read_bytes() == self._render(number)
        )

    def _redirect_includes(
        self, places: list[Path], changed: set[int], include_lines: IncludeLines
    ) -> None:
        files = self._sources.files
        for number, file in enumerate(files):
            if places[number] == file.path:
                continue
            folder = places[number].parent
            for statement, target in file.includes:
                stays = places[target] == files[target].path
                is_fixed = (
                    not self._sources.search.is_relative(statement.written)
                    and target not in changed
                )
                lead = self._lead(statement, folder, places[0].parent, places)
                if is_fixed or lead == places[target]:
                    continue
                new = str(places[target]) if stays else os.path.relpath(places[target], folder)
                eol = self._file_eol(number)
                span = range(statement.first, statement.stop)
                rows = include_lines([file.lines[line] for line in span], new)
                self._replaced[number] |= dict.fromkeys(span, "")
                self._replaced[number][statement.first] = "".join(row + eol for row in rows)


def _below(path: Path, folder: Path) -> Path:
    """Path of a file from a folder without the steps out of it: 'a/g.dat' of '../a/g.dat'."""
    parts = Path(os.path.relpath(path, folder)).parts
    return Path(*[part for part in parts if part != os.pardir])


def _own_name(path: Path, name: str, taken: set[Path]) -> Path:
    """Make a name that can only belong to the deck ``path``."""
    candidate = path.with_name(f"{path.stem}_{name}")
    count = 2
    while candidate in taken:
        candidate = path.with_name(f"{path.stem}_{count}_{name}")
        count += 1
    return candidate


def _eol(line: str) -> str:
    return line[len(line.rstrip("\r\n")) :]
