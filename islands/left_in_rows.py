"""Left in rows: elements that fail by size alone, where nothing can be done without harm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops.criteria import ASPECT_RATIO, MAX_LENGTH, MIN_SIZE, NAMES
from meshops.mesh import Bools
from meshops.rows import rows_across
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class LeftInRows:
    """Elements in regular rows that fail by size alone, and are left as they are.

    Attributes
    ----------
    elements : int
    criteria : tuple of str
        Those that they fail.
    rows : (int, int) or None
        The fewest and the most across the strips that they lie in; None where they lie in none.
    """

    elements: int
    criteria: tuple[str, ...] = ()
    rows: tuple[int, int] | None = None

    @classmethod
    def of(cls, workpiece: Workpiece) -> LeftInRows:
        """Find those of a mesh."""
        left = workpiece.in_regular_rows
        if not left.any():
            return cls(0)
        failed: Bools = np.any(workpiece.failed_criteria[left], axis=0)
        names = [NAMES[c] for c in (MIN_SIZE, MAX_LENGTH, ASPECT_RATIO) if failed[c]]
        return cls(
            int(np.count_nonzero(left)),
            tuple(names),
            rows_across(workpiece.topology, left),
        )

    def words(self) -> str:
        """Say what they would need; nothing where there are none."""
        if not self.elements:
            return ""
        one = self.elements == 1
        where = ""
        if self.rows is not None:
            fewest, most = self.rows
            where = f" {fewest} wide" if fewest == most else f" {fewest} to {most} wide"
        return (
            f"{self.elements:,} element{'s' * (not one)} fail{'s' * one} by "
            f"{' and '.join(self.criteria)} alone, in rows{where}, and "
            f"{'is' if one else 'are'} left: another density would be needed"
        )
