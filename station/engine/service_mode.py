"""Service mode: a lease that one user holds and must renew while READY is 0 and MODE is 3."""

import logging
import time

from station.engine.orders import Service
from station.plc.map.registers import Status

log = logging.getLogger("weldgate.service")

LEASE_S = 3.0
"""Time after which service mode lapses if the window is killed or hangs."""


class ServiceMode:
    """The last request for service mode, while its lease holds."""

    def __init__(self) -> None:
        self._request: Service | None = None
        self._until_s = -1e9

    def take_in(self, request: Service) -> None:
        """Begin, renew or end service mode; requests of another user than the holder are ignored."""
        if self.who not in ("", request.who):
            return
        if request.ended:
            self._until_s = -1e9
        elif not self.who:
            log.info("service mode: begun by %s", request.who)
        self._request = request
        if not request.ended:
            self._until_s = time.monotonic() + LEASE_S

    @property
    def who(self) -> str:
        """User in service mode, or empty."""
        return self._request.who if self._request is not None and time.monotonic() < self._until_s else ""

    @property
    def bit(self) -> int:
        """Bit of STATUS to set by hand; 0: none."""
        bit = self._request.bit if self._request is not None and self.who else 0
        return bit if bit in [int(flag) for flag in Status] else 0

    @property
    def setup_images(self) -> Service | None:
        """Request for setup images; None if there is none."""
        request = self._request
        return request if request is not None and self.who and request.setup_images else None
