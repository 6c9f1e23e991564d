"""Who hears of what the engine does, and orders things of it; must not block."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from station.channel.events import Event, Preview
from station.engine.orders import Order


@dataclass(frozen=True, slots=True)
class Listener:
    """The cycle's connections to the people at the station."""

    event: Callable[[Event], None]
    preview: Callable[[Preview], None]
    orders: Callable[[], Sequence[Order]] = tuple
    """Returns what people ask for, once it was allowed."""
