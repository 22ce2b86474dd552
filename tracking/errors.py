"""What is raised when something asked of the tracking cannot be given."""

from __future__ import annotations


class TrackingError(Exception):
    """A missing or unreadable record, in one sentence for the user that says what to do."""
