"""What pages share: what was received, the login, service mode, changes of settings."""

from pathlib import Path

from PySide6.QtCore import QObject, Signal

from station.panel.session.account import Account
from station.panel.session.bridge import Bridge
from station.panel.session.change_client import ChangeClient
from station.panel.session.engine_requests import EngineRequests
from station.panel.session.received import Received
from station.panel.session.service_client import ServiceClient
from station.settings.model import Settings


class Session(QObject):
    """Holds the connection to the engine and the four objects that pages use; each keeps its own state."""

    part_chosen = Signal(int)
    """Carries the number of a part that is to be shown on the page History."""

    def __init__(self, bridge: Bridge, settings: Settings, path: Path) -> None:
        """Build the four objects on a connection; `settings` were read from the file `path`."""
        super().__init__()
        self.bridge, self._requests = bridge, EngineRequests(bridge)
        self.received = Received(bridge, settings, path)
        self.account = Account(self._requests, self.received)
        self.service = ServiceClient(self.account)
        self.change = ChangeClient(self.account)
        self.change.used.connect(self.received.read_settings)

    def close(self) -> None:
        """Log out, stop the timers and close the channel."""
        self.service.close()
        self.account.close()
        self._requests.close()
        self.bridge.close()
