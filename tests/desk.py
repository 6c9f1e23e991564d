"""The part of an engine that serves windows, without a line: real journal, accounts, settings and channel."""

import threading
import time
from collections.abc import Callable
from pathlib import Path

from station.camera.reconnecting import ReconnectingCamera
from station.channel.request_socket import RequestClient, RequestServer
from station.channel.requests import Answer, EndService, Message, Request
from station.domain import Frame
from station.engine.active_settings import ActiveSettings
from station.engine.operator_requests import OperatorRequests
from station.engine.orders import Order, OrderQueue, Reload, UseSettings
from station.engine.settings_use import use_settings
from station.errors import CameraLost
from station.inspection.loading import Loaded
from station.journal.accounts import Accounts
from station.journal.users import Level, users
from station.settings.camera import AnyCamera
from station.settings.file import load
from station.settings.keys import keys_folder

PIN = "123456"


class StubCamera:
    """Opens unless its exposure is out of its range."""

    def __init__(self, settings: AnyCamera) -> None:
        self.exposure_us: float = getattr(settings, "exposure_us", 1.0)

    def open(self) -> None:
        if self.exposure_us < 1:
            raise CameraLost("exposure out of range")

    def alive(self) -> bool:
        return True

    def grab(self, trigger_s: float) -> Frame:
        raise CameraLost("no frames here")

    def adjust(self, exposure_us: float | None, gain_db: float | None) -> None:
        """Nothing to do."""

    def close(self) -> None:
        """Nothing to do."""


class Desk:
    """Answers on the channel of a settings file; a thread takes the place of the cycle between parts."""

    def __init__(self, path: Path, turns: bool = True) -> None:
        """`turns`: the cycle takes changed settings."""
        self.path, self.turns, self.given = path, turns, list[Order]()
        self.used: list[Loaded] = []
        self._queue, self._stop = OrderQueue(), threading.Event()
        self.active = ActiveSettings(load(path), lambda: load(path), StubCamera)
        self._camera = ReconnectingCamera(self.active.make_camera(), 1.0)
        self._server = RequestServer(self.active.settings.channel)
        self.requests = OperatorRequests(self._server, path, self.active, self._queue.put)
        self._thread = threading.Thread(target=self._run, name="turns")
        self._thread.start()

    def _run(self) -> None:
        waiting: list[UseSettings | Reload] = []
        while not self._stop.wait(0.005):
            orders = self._queue.take()
            self.given += orders
            waiting += [order for order in orders if isinstance(order, UseSettings | Reload)]
            while self.turns and waiting:
                order = waiting.pop(0)
                if order.ticket.take():
                    if isinstance(order, UseSettings):
                        use_settings(
                            order,
                            active=self.active,
                            camera=self._camera,
                            number=1,
                            use=self.used.append,
                        )
                    else:
                        self.active.activate(self.active.prepare_file(1))
                        order.ticket.answer("")

    def knows(self, name: str, level: Level) -> None:
        """Add a user with the common PIN; an administrator is added before the first one."""
        folder = self.active.settings.archive.folder
        accounts = Accounts(folder, keys_folder(self.path))
        if not users(folder):
            accounts.save_user("Root", level=Level.ADMIN, pin=PIN, by="Root")
        accounts.save_user(name, level=level, pin=PIN, by="Root")

    def close(self) -> None:
        self.requests.close()
        self._stop.set()
        self._thread.join(timeout=100)
        self._server.close()


class PlainWindow:
    """A window without pages: sends requests and waits for the answers."""

    def __init__(self, path: Path) -> None:
        self._client, self._last, self.token = RequestClient(load(path).channel), 0, ""
        self._answers: dict[int, Answer] = {}
        self.until(lambda: self._client.send(Message(0, time.monotonic(), EndService())))  # connected

    def until(self, there: Callable[[], bool], patience_s: float = 10.0) -> None:
        end = time.monotonic() + patience_s
        while not there():
            assert time.monotonic() < end, "never came"
            time.sleep(0.005)

    def send(self, request: Request) -> int:
        self._last += 1
        assert self._client.send(Message(self._last, time.monotonic(), request, self.token))
        return self._last

    def answer(self, number: int) -> Answer:
        def there() -> bool:
            self._answers |= {answer.request_id: answer for answer in self._client.answers()}
            return number in self._answers

        self.until(there)
        return self._answers.pop(number)

    def ask(self, request: Request) -> Answer:
        answer = self.answer(self.send(request))
        self.token = answer.token or self.token
        return answer

    def close(self) -> None:
        self._client.close()
