"""The function by which long work reports its progress and learns that it was cancelled."""

from collections.abc import Callable

Progress = Callable[[int, int], bool]
"""Function that takes how much is done, of how much, and returns False if the work was cancelled."""
