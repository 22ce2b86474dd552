"""What independent readers say of the decks that the optimiser writes.

``python -m benchmarks.verifiers --python VENV/bin/python`` improves every Nastran and Abaqus deck
of the shared folder and runs that folder's verifiers on it: pyNastran, a reader of Abaqus decks
with VTK, and with ``--solve`` CalculiX. They need an environment of their own (``pip install
pyNastran scipy "numpy<2" vtk``). Listed is what they call bad; there should be nothing.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from argparse import Namespace
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.harm_decks import SHARED
from benchmarks.report import Row, parser, publish
from benchmarks.verdicts import bad
from meshops.formats.suffixes import ABAQUS, NASTRAN

ROOT = Path(__file__).resolve().parents[1]

REFUSED = 2
"""Exit code of the optimiser for a deck that it does not work on."""


def decks(shared: Path, only: str) -> Iterator[Path]:
    """Yield the decks of the shared folder, those that others include aside."""
    for path in sorted(p for folder in ("data", "faults") for p in (shared / folder).rglob("*")):
        is_deck = path.suffix.lower() in (*NASTRAN, *ABAQUS)
        if is_deck and only in str(path) and not _is_included(path):
            yield path


def verify(deck: Path, options: Namespace) -> Row:
    """Improve one deck and ask the verifiers."""
    started = time.monotonic()
    with TemporaryDirectory() as folder:
        out = Path(folder) / "run"
        done = _optimised(deck, out, options)
        if done.returncode == REFUSED:
            return Row(str(deck), f"refused: {_last(done)}", "", met=True)
        after = _written(deck, out)
        if done.returncode or after is None:
            return Row(
                str(deck), f"exit code {done.returncode}: {_last(done)}", "a deck", met=False
            )
        lines = _judged(deck, after, options)
    seconds = f"{time.monotonic() - started:.0f} s"
    found = bad(lines)
    told = "; ".join(found) or f"nothing bad, {seconds}"
    return Row(str(deck), told, "nothing bad", met=not found)


def _optimised(deck: Path, out: Path, options: Namespace) -> subprocess.CompletedProcess[str]:
    command = [
        sys.executable,
        *("-c", "from islands.cli import main; main()"),
        *("optimize", str(deck), "--out", str(out), "--criteria", options.criteria),
        *("--seed", "1", "--time-limit", str(options.time_limit), "--track", "off", "--quiet"),
    ]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(
        command, cwd=out.parent, env=environment, capture_output=True, text=True, check=False
    )


def _judged(before: Path, after: Path, options: Namespace) -> Sequence[str]:
    """Lines of all verifiers that know the format."""
    is_abaqus = before.suffix.lower() in ABAQUS
    scripts = ["verify_abaqus.py" if is_abaqus else "verify_nastran.py"]
    if is_abaqus and options.solve:
        scripts.append("solve_calculix.py")
    lines: list[str] = []
    for script in scripts:
        command = [options.python, str(options.shared / "tools" / script), str(before), str(after)]
        told = subprocess.run(
            command, cwd=after.parent, capture_output=True, text=True, check=False
        )
        lines += [*told.stdout.splitlines(), *told.stderr.splitlines()]
        if told.returncode:
            lines.append(f"BAD {script} ends with exit code {told.returncode}: {_last(told)}")
    if options.verbose:
        print("\n".join([str(before), *(f"    {line}" for line in lines)]), file=sys.stderr)
    return lines


def _written(deck: Path, out: Path) -> Path | None:
    """Find the deck in the run's folder, where it may have a folder of its own."""
    return next(iter(sorted(out.rglob(deck.name), key=lambda path: len(path.parts))), None)


def _is_included(path: Path) -> bool:
    """Whether a deck above it in its folders reads this file."""
    above = [path.parent, path.parent.parent]
    others = [p for folder in above for p in folder.glob("*") if p.is_file() and p != path]
    others += [p for p in path.parent.parent.glob("*/*") if p.is_file() and p != path]
    named = path.name.lower().encode()
    return any(
        named in line and line.lstrip(b"* ").startswith(b"include")
        for other in others
        for line in other.read_bytes().lower().splitlines()
    )


def _last(done: subprocess.CompletedProcess[str]) -> str:
    lines = (done.stderr or done.stdout).strip().splitlines()
    return lines[-1] if lines else "no word"


def main() -> None:
    """Verify all decks, or those whose path has a text."""
    options = parser(__doc__)
    options.add_argument("--python", required=True, help="of the verifiers' environment")
    options.add_argument("--shared", type=Path, default=SHARED, help="folder of data and tools")
    options.add_argument("--criteria", default="paper")
    options.add_argument("--time-limit", type=float, default=20.0, metavar="S", help="for a deck")
    options.add_argument("--only", metavar="TEXT", default="", help="decks whose path has this")
    options.add_argument("--solve", action="store_true", help="solve Abaqus decks with CalculiX")
    options.add_argument("--verbose", action="store_true", help="show all that they say")
    chosen = options.parse_args()
    rows = []
    for deck in decks(chosen.shared, chosen.only):
        rows.append(verify(deck, chosen))
        print(f"{deck.name}: {'done' if rows[-1].met else 'BAD'}", file=sys.stderr)
    missed = sum(not row.met for row in rows)
    rows.append(Row("all decks", f"{missed} bad of {len(rows)}", "0 bad", met=not missed))
    publish("Decks as independent readers see them", rows, {}, chosen)


if __name__ == "__main__":
    main()
