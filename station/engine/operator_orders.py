"""Orders of operators to the cycle: they wait until READY is 0 and no part is in progress or unread."""

import time
from collections.abc import Sequence

from station.engine.orders import Order, Reload, ResetCounts, Service, TestImage, UseSettings
from station.engine.service_mode import ServiceMode
from station.plc.map.registers import Status

SETTLE_S = 0.2
"""Time after which a trigger that was accepted while READY fell shows in the bits of STATUS."""

Task = TestImage | Reload | UseSettings
"""An order that waits for a moment without a part in progress."""


class OperatorOrders:
    """Orders that wait for their moment, one of each kind, and service mode."""

    def __init__(self) -> None:
        self.service = ServiceMode()
        self._tasks: dict[type[Task], Task] = {}
        self._since_s = 0.0

    def take_in(self, orders: Sequence[Order]) -> list[ResetCounts]:
        """Take in orders, of each kind the last one, and return those that need not wait."""
        for order in orders:
            if isinstance(order, Service):
                self.service.take_in(order)
            elif isinstance(order, TestImage | Reload | UseSettings):
                if not self._tasks:
                    self._since_s = time.monotonic()
                self._tasks[type(order)] = order
        return [order for order in orders if isinstance(order, ResetCounts)]

    @property
    def waiting(self) -> bool:
        """True if READY must be 0 because an order waits."""
        return bool(self._tasks)

    def next_task(self, status: Status) -> Task | None:
        """Return an order that the bits of STATUS allow now, each order once; None if there is none."""
        if not self._tasks or not no_part_in_progress(status) or time.monotonic() - self._since_s < SETTLE_S:
            return None
        task = self._tasks.pop(next(iter(self._tasks)))
        return task if isinstance(task, TestImage) or task.ticket.take() else None


def no_part_in_progress(status: Status) -> bool:
    """Return whether no trigger is accepted, no part is in progress and no result waits to be read."""
    return not status & (Status.READY | Status.BUSY | Status.RESULT_VALID | Status.TRIGGER_ACK)
