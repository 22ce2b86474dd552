"""The guard: what of a change is kept, so that no mesh becomes worse in any respect.

Every edit that a procedure makes of a mesh passes it, in a subdomain and once more at the end of a
run against the mesh that the run began with. What has become of the mesh is told by its own nodes
and elements (`correspondence`), nodes go home where they need not have moved (`restoring`), and
each connected change is kept or taken back by itself (`rules`).
"""

from meshops.guard.correspondence import count_changed
from meshops.guard.guarding import guarded, guarded_edits

__all__ = ["count_changed", "guarded", "guarded_edits"]
