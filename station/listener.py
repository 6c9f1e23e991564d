"""Who hears of what the engine does, and asks things of it; must not block."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from station.events import Event, Preview
from station.requests import Request


@dataclass(frozen=True, slots=True)
class Listener:
    """The engine's side of the channel."""

    event: Callable[[Event], None]
    preview: Callable[[Preview], None]
    requests: Callable[[], Sequence[Request]] = tuple
    """What people ask for."""
