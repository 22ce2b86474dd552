"""Places of the quality sums: what elements add up to, from which Q.I. and fitness follow.

Quality sums are a float64 vector of ``TALLY_SIZE``. Criterion ``c`` has at ``4 * c`` the sum of the
penalties that pass, then how many pass, the sum of those that fail, and how many fail. The last
places count elements, quads, trias, failed elements, irregular nodes and elements that fail by
shape, and add up the severity of faults of shape and of size: the penalties beyond the fail level,
1 for what is just beyond its bound. Elements can be added and taken away, so an edit is scored by
the elements that it touches. Irregular nodes do not follow from elements one by one: the core
leaves that place 0, and a workpiece fills it. NaN stands for no valid mesh.
"""

from __future__ import annotations

ELEMENTS, QUADS, TRIAS, FAILED, IRREGULAR, SHAPE_FAILED, SHAPE, SIZE = range(48, 56)

TALLY_SIZE = 56
"""How many numbers quality sums are."""
