"""Gate: conditions on a report under which a mesh is not good enough."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from meshops.criteria import NAMES
from meshops.errors import InputError
from meshops.quality_index import QualityIndex

FIGURES: Mapping[str, Callable[[QualityIndex], float]] = {
    "failed": lambda report: report.failed,
    "shape": lambda report: report.failed_by_shape,
    "size": lambda report: report.failed_by_size,
    "trias": lambda report: report.trias,
    "percent-trias": lambda report: report.percent_trias,
    "compound-qi": lambda report: report.compound_qi,
    "mean-qi": lambda report: report.mean_element_qi,
    "elements": lambda report: report.elements,
    "quads": lambda report: report.quads,
}
"""Figures of a whole mesh by the names that a condition may use besides those of the criteria."""

_OPERATORS: Mapping[str, Callable[[float, float], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "==": operator.eq,
    "<": operator.lt,
    ">": operator.gt,
}

_CONDITION = re.compile(r"\s*(?P<name>[^<>=]*?)\s*(?P<sign><=|>=|==|<|>)\s*(?P<limit>\S+)\s*")


@dataclass(frozen=True)
class Condition:
    """A condition like ``failed>0`` or ``min angle quad<40``: the worst value of a criterion.

    Attributes
    ----------
    name : str
        A name of ``FIGURES`` or of a criterion.
    sign : str
        One of < <= > >= ==.
    limit : float
    """

    name: str
    sign: str
    limit: float

    @classmethod
    def parse(cls, text: str) -> Condition:
        """Read a condition; raises InputError where it is none."""
        found = _CONDITION.fullmatch(text)
        if found is None:
            raise InputError(
                f'"{text}" is no condition: write a name, one of {" ".join(_OPERATORS)} and a '
                'number, like "failed>0".'
            )
        names = {name.lower(): name for name in (*FIGURES, *NAMES)}
        name = names.get(found["name"].lower())
        if name is None:
            raise InputError(
                f'"{text}": there is no figure "{found["name"]}"; there are {", ".join(FIGURES)} '
                f"and the worst values {', '.join(NAMES)}."
            )
        try:
            limit = float(found["limit"])
        except ValueError:
            limit = float("nan")
        if limit != limit:
            raise InputError(f'"{text}": "{found["limit"]}" is not a number.')
        return cls(name, found["sign"], limit)

    def value(self, report: QualityIndex) -> float | None:
        """Return the figure of a report; None where no element has one.

        Raises InputError where the criterion is not active: a gate must not stay open by that.
        """
        if self.name in FIGURES:
            return float(FIGURES[self.name](report))
        row = report.rows[NAMES.index(self.name)]
        if not row.active:
            raise InputError(
                f'"{self.name}" is not looked at by the criteria {report.criteria}: '
                "leave the condition out, or give criteria in which it is active."
            )
        return row.worst

    def is_met(self, report: QualityIndex) -> bool:
        """Whether a report meets the condition."""
        value = self.value(report)
        return value is not None and _OPERATORS[self.sign](value, self.limit)

    def sentence(self, report: QualityIndex) -> str:
        """Say which condition is met, and by what."""
        whose = "" if self.name in FIGURES else "the worst "
        return f'Fails on "{self.name}{self.sign}{self.limit:g}": {whose}{self.name} is ' + (
            f"{self.value(report):g}."
        )
