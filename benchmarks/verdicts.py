"""What of the lines of the independent verifiers is bad.

That of Nastran decks says so itself; that of Abaqus decks and CalculiX print figures, which are
judged here.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

MARKS = ("BAD", "!!", "DANGLING", "Traceback")
"""Words in a line that tells a fault by itself."""

_NUMBER = r"([-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?)"


@dataclass(frozen=True)
class Rule:
    """A figure before and after in a line.

    Attributes
    ----------
    name : str
    pattern : str
        With a group for each of the two figures.
    rise, fall : float
        By how much it may rise and fall.
    relative : bool
        Whether these are shares of the figure before.
    """

    name: str
    pattern: str
    rise: float = 0.0
    fall: float = float("inf")
    relative: bool = False


def _rises(name: str, pattern: str, by: float = 0.0) -> Rule:
    return Rule(name, pattern, rise=by)


RULES = (
    _rises("trias", rf"trias {_NUMBER} -> {_NUMBER}"),
    Rule("area", rf"area {_NUMBER}->{_NUMBER}", 0.001, 0.001, relative=True),
    _rises("inverted", rf"concave/inverted {_NUMBER} -> {_NUMBER}"),
    _rises("degenerate", rf"degenerate {_NUMBER} -> {_NUMBER}"),
    _rises("missing nodes", rf"missing nodes {_NUMBER} -> {_NUMBER}"),
    Rule("least angle", rf"min ang {_NUMBER}->{_NUMBER}", float("inf"), 0.1),
    _rises("largest angle", rf"max ang {_NUMBER}->{_NUMBER}", 0.1),
    _rises("aspect", rf"max aspect {_NUMBER}->{_NUMBER}", 0.01),
    _rises("nodes at one place", rf"coincident node pairs {_NUMBER} -> {_NUMBER}"),
    _rises("orphan nodes", rf"orphan nodes {_NUMBER} -> {_NUMBER}"),
    _rises("flipped trias", rf"flipped triangles ()?{_NUMBER}"),
)
"""Of the verifier of Abaqus decks."""

DISPLACEMENT, REACTION = 0.02, 0.001
"""Shares that CalculiX's largest displacement and its reactions may change by."""


def bad(lines: Sequence[str]) -> list[str]:
    """Return what is bad, one sentence each."""
    found = [line.strip() for line in lines if any(mark in line for mark in MARKS)]
    for line in lines:
        for rule in RULES:
            for before, after in re.findall(rule.pattern, line):
                if _breaks(rule, float(before or 0.0), float(after)):
                    found.append(f"{rule.name} {before or 0} -> {after}")
    return [*found, *_solutions(lines)]


def _breaks(rule: Rule, before: float, after: float) -> bool:
    scale = abs(before) if rule.relative else 1.0
    change = after - before
    return change > rule.rise * scale + 1e-9 or -change > rule.fall * scale + 1e-9


def _solutions(lines: Iterable[str]) -> list[str]:
    """Compare what CalculiX found before and after."""
    told = {line.split()[0]: line for line in lines if re.match(r"(before|after) rc ", line)}
    if len(told) < 2 or "finished True" not in told["before"]:
        return []
    if "finished True" not in told["after"]:
        return [f"CalculiX does not solve it any more: {told['after']}"]
    found = []
    one, other = (re.findall(rf"umax {_NUMBER}", told[name]) for name in ("before", "after"))
    if one and other and abs(float(other[0]) - float(one[0])) > DISPLACEMENT * abs(float(one[0])):
        found.append(f"largest displacement {one[0]} -> {other[0]}")
    forces = [_reaction(told[name]) for name in ("before", "after")]
    largest = max(map(abs, forces[0]), default=0.0)
    if any(abs(b - a) > REACTION * largest for a, b in zip(*forces, strict=False)):
        found.append(f"reactions {forces[0]} -> {forces[1]}")
    return found


def _reaction(line: str) -> list[float]:
    vector = re.search(r"R at BC \[(.*?)\]", line)
    return [float(number) for number in vector.group(1).split()] if vector else []
