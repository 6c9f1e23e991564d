"""LearningError: a user's mistake in a learning command, reported in one line."""

from collections.abc import Sequence
from pathlib import Path

SHOWN = 10


class LearningError(Exception):
    """What is wrong, where, and what to do about it."""


def listed(folder: Path, wrong: Sequence[str]) -> str:
    """Return a message on what is wrong in a folder, naming the first ten problems."""
    more = f" and {len(wrong) - SHOWN} more" if len(wrong) > SHOWN else ""
    shown = "; ".join(wrong[:SHOWN])
    return f"{folder}: {len(wrong)} wrong: {shown}{more}. Correct them, or make the folder again"
