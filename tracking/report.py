"""A run in words: the Markdown note that goes with its record."""

from __future__ import annotations

from tracking.events import RunFinished, RunStarted, known_before

NOTE_LENGTH = 5000
"""Characters: what every MLflow server takes as the value of a tag."""

_ROWS = (
    ("elements", "elements"),
    ("quads", "quads"),
    ("trias", "trias"),
    ("failed elements", "failed"),
    ("by shape", "failed_by_shape"),
    ("by size alone", "failed_by_size"),
    ("compound Q.I.", "compound_qi"),
)


def markdown_report(started: RunStarted, finished: RunFinished | None = None) -> str:
    """Tell a run in Markdown: the mesh before and after, how it ended, and the procedure.

    At most ``NOTE_LENGTH`` characters: a long note of the user's gets half of them, and a procedure
    that does not fit into the rest is cut between two lines.
    """
    after = finished.after if finished else None
    parts = [_cut(started.note, NOTE_LENGTH // 2)] if started.note else []
    lines = ["| | before | after |", "|---|---:|---:|"]
    for title, name in _ROWS:
        value = "" if after is None else f"{getattr(after, name):.6g}"
        lines.append(f"| {title} | {getattr(started.before, name):.6g} | {value} |")
    parts.append("\n".join(lines))
    if started.told:
        parts.append(_cut("\n".join(f"- {line}" for line in started.told), NOTE_LENGTH // 4))
    if finished:
        parts.append(
            f"{finished.status.capitalize()} after {finished.seconds:.1f} s and "
            f"{finished.evaluations} evaluations, {known_before(finished):.0%} of them known "
            f"before: {finished.reason}. "
            f"Fitness {finished.fitness:.6g}."
        )
        if finished.worse:
            parts.append(f"Worse than before: {'; '.join(finished.worse)}.")
    text = "\n\n".join(parts)
    if finished and finished.procedure:
        room = NOTE_LENGTH - len(text) - len("\n\n```\n\n```")
        text += f"\n\n```\n{_cut(finished.procedure, room)}\n```"
    return text


def _cut(text: str, length: int) -> str:
    """Cut a text that is too long, between two lines if it has any, and show that it was cut."""
    if len(text) <= length:
        return text
    head = text[: max(length - 2, 0)]
    return (head.rpartition("\n")[0] or head) + "\n…"
