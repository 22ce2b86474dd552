"""What all benchmarks share: a table on the terminal, JSON on request, a check of the targets."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Row:
    """One line of a benchmark's table.

    Attributes
    ----------
    case : str
    measured : str
        The figure in words, with its range where there is one.
    target : str
        What it should reach; empty where nothing is asked.
    met : bool
    """

    case: str
    measured: str
    target: str
    met: bool


def parser(description: str | None) -> argparse.ArgumentParser:
    """Make the options that every benchmark has."""
    options = argparse.ArgumentParser(description=description)
    options.add_argument("--json", type=Path, metavar="FILE", help="write the figures as JSON")
    options.add_argument("--check", action="store_true", help="exit 1 where a target is missed")
    return options


def publish(
    title: str, rows: Sequence[Row], details: Mapping[str, Any], options: argparse.Namespace
) -> None:
    """Print the table, write the JSON, and with --check exit 1 where a target is missed."""
    heads = ("case", "measured", "target", "met")
    cells = [heads, *((r.case, r.measured, r.target, _tick(r)) for r in rows)]
    widths = [max(len(line[k]) for line in cells) for k in range(len(heads))]
    print(title)
    for line in cells:
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)))
    if options.json:
        document = {"title": title, "rows": [asdict(row) for row in rows], **details}
        options.json.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    if options.check and not all(row.met for row in rows):
        sys.exit(1)


def _tick(row: Row) -> str:
    if not row.target:
        return ""
    return "yes" if row.met else "NO"
