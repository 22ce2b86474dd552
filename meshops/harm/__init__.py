"""What an edit has done to a mesh, measured by code that shares nothing with the search.

``compare`` gives the columns, before and after; ``Harm.worse`` says in sentences what has become
worse; ``verify`` says what of it must not be written. Only arrays go in: numpy and scipy measure.
"""

from meshops.harm.compare import compare, local_sizes, median_size, verify
from meshops.harm.edges import middles_of
from meshops.harm.report import Harm, Standing

__all__ = ["Harm", "Standing", "compare", "local_sizes", "median_size", "middles_of", "verify"]
