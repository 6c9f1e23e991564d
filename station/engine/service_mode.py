"""Someone works on the station: a lease that must be renewed, and pictures for setting up camera and light."""

import logging
import time
from collections.abc import Sequence

import numpy as np

from station.camera.reconnecting import ReconnectingCamera
from station.channel.events import SETTING_UP, LookEvent, Preview
from station.channel.preview import make_preview
from station.engine.orders import Order, Reload, ResetCounts, Service, TestPicture, UseSettings
from station.errors import LocateError, ModelError
from station.inspection.inspector import Inspector
from station.plc.map.registers import Status
from station.vision.quality import measure
from station.vision.unwrap import unwrap

log = logging.getLogger("weldgate.service")

SETTLE_S = 0.2
"""A trigger that was accepted while READY fell shows in the bits by then."""
LEASE_S = 3.0
"""A window that is killed or hangs lets the station go on after this time."""
CLASSES = 64


class ServiceMode:
    """What the last request said, while it holds."""

    def __init__(self) -> None:
        self._said: Service | None = None
        self._until_s = -1e9

    def heard(self, request: Service) -> None:
        """A request to begin, to go on or to end; whoever works here first is not put out by another window."""
        if self.who not in ("", request.who):
            return
        if request.over:
            self._until_s = -1e9
        elif not self.who:
            log.info("service mode: %s works on the station", request.who)
        self._said = request
        if not request.over:
            self._until_s = time.monotonic() + LEASE_S

    @property
    def who(self) -> str:
        """Who works on the station, or empty."""
        return self._said.who if self._said is not None and time.monotonic() < self._until_s else ""

    @property
    def bit(self) -> int:
        """The bit of STATUS to set; 0: none."""
        held = self._said.bit if self._said is not None and self.who else 0
        return held if held in [int(flag) for flag in Status] else 0

    @property
    def looking(self) -> Service | None:
        """What pictures are wanted."""
        return self._said if self._said is not None and self.who and self._said.look else None


Task = TestPicture | Reload | UseSettings
"""Orders that wait for a moment without a part in work."""


class Attention:
    """Orders of people next to parts: they wait until READY is 0 and no part is in work or unread."""

    def __init__(self) -> None:
        self.service = ServiceMode()
        self._tasks: dict[type[Task], Task] = {}
        self._since_s = 0.0

    def hear(self, orders: Sequence[Order]) -> list[ResetCounts]:
        """Take in orders, of each kind the last counts; return those that need not wait."""
        for order in orders:
            if isinstance(order, Service):
                self.service.heard(order)
            elif isinstance(order, TestPicture | Reload | UseSettings):
                if not self._tasks:
                    self._since_s = time.monotonic()
                self._tasks[type(order)] = order
        return [order for order in orders if isinstance(order, ResetCounts)]

    @property
    def waiting(self) -> bool:
        """True if READY must be 0 for something that was ordered."""
        return bool(self._tasks)

    def due(self, status: Status) -> Task | None:
        """Return what can be done now, by the bits that the PLC reads; it is taken once."""
        if not self._tasks or not drained(status) or time.monotonic() - self._since_s < SETTLE_S:
            return None
        task = self._tasks.pop(next(iter(self._tasks)))
        return task if isinstance(task, TestPicture) or task.ticket.take() else None


def drained(status: Status) -> bool:
    """No trigger is taken, no part is in work, no result waits to be read."""
    return not status & (Status.READY | Status.BUSY | Status.RESULT_VALID | Status.TRIGGER_ACK)


def look(
    camera: ReconnectingCamera, inspector: Inspector, wanted: Service
) -> tuple[LookEvent, Preview | None]:
    """One picture with its numbers."""
    camera.adjust(wanted.exposure_us, wanted.gain_db)
    grab = camera.grab()
    if grab.frame is None:
        event = LookEvent(
            exposure_us=wanted.exposure_us,
            gain_db=wanted.gain_db,
            mean_dn=0.0,
            saturated_share=0.0,
            sharpness=0.0,
            histogram=(),
            ring=None,
            problem=str(grab.reason),
        )
        return event, None
    image, ring, problem = grab.frame.image, None, ""
    try:
        ring = inspector.locate(image)
    except (LocateError, ModelError) as error:
        problem = str(error)
    shown = image if ring is None else unwrap(image, ring)
    quality = measure(shown)
    counts, _ = np.histogram(shown, CLASSES, (0, 256))
    event = LookEvent(
        exposure_us=wanted.exposure_us,
        gain_db=wanted.gain_db,
        mean_dn=quality.mean_dn,
        saturated_share=quality.saturated_share,
        sharpness=quality.sharpness,
        histogram=tuple(int(count) for count in counts),
        ring=ring,
        problem=problem,
    )
    return event, make_preview(SETTING_UP, image, ring)
