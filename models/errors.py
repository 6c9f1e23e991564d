"""LearningError: a user's mistake in a learning command, said in one line."""

from collections.abc import Sequence
from pathlib import Path

SHOWN = 10


class LearningError(Exception):
    """What is wrong, where, and what to do."""


def listed(folder: Path, wrong: Sequence[str]) -> str:
    """Message naming what is wrong in a folder, the first ten one by one."""
    more = f" and {len(wrong) - SHOWN} more" if len(wrong) > SHOWN else ""
    return f"{folder}: {len(wrong)} wrong: {'; '.join(wrong[:SHOWN])}{more}; correct them or make the folder again"
