"""The cycle's connection to the operators: where its events go and where its orders come from."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from station.channel.events import Event, Preview
from station.engine.orders import Order


@dataclass(frozen=True, slots=True)
class Listener:
    """Functions that the cycle calls; none of them may block."""

    event: Callable[[Event], None]
    """Takes each event of the cycle."""
    preview: Callable[[Preview], None]
    """Takes each image for the window."""
    orders: Callable[[], Sequence[Order]] = tuple
    """Returns the new orders of operators, already checked against their rights."""
