"""Answers the requests of windows in its own threads, so that neither PINs nor the journal delay a part."""

import logging
import queue
import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path

from station.channel.events import Event, StatusEvent
from station.channel.request_socket import RequestServer
from station.channel.requests import FAULT, Answer, ChangeSettings, Message, ReloadSettings
from station.engine.active_settings import ActiveSettings
from station.engine.check_ins import IDLE_S, CheckIns
from station.engine.logins import Logins
from station.engine.operator_desk import OperatorDesk, Reply
from station.engine.orders import Order
from station.engine.settings_change import PATIENCE_S, SettingsChange
from station.errors import WeldgateError
from station.journal.accounts import Accounts
from station.plc.port import Counts
from station.settings.keys import keys_folder

log = logging.getLogger("weldgate.requests")

POLL_S = 0.05
"""Longest wait for a request."""
MAX_CHANGES = 16
"""Number of changes of settings that may wait."""
TOO_MANY = "too many changes of settings are waiting. Try again."
"""Refusal of a further change."""


class OperatorRequests:
    """Owner of accounts, settings, acknowledgements and their journal entries; the cycle only gets orders."""

    def __init__(
        self,
        server: RequestServer,
        path: Path,
        active: ActiveSettings,
        hand_over: Callable[[Order], None],
        *,
        check_ins: CheckIns | None = None,
    ) -> None:
        """`path`: path of the settings file; `hand_over` gives an order to the cycle."""
        self._server, self._stop = server, threading.Event()
        self._check_ins = check_ins or CheckIns()
        self._status: StatusEvent | None = None
        logins = Logins(lambda: active.settings.panel.logout_min * 60)
        folder = active.settings.archive.folder
        accounts = Accounts(folder, keys_folder(path))
        self._desk = OperatorDesk(folder, logins, accounts, hand_over=hand_over, counts=self._counts)
        self._change = SettingsChange(path, active, hand_over=hand_over, recipe=self._recipe, stop=self._stop)
        self._answers: queue.SimpleQueue[tuple[int, Answer]] = queue.SimpleQueue()
        self._changes: queue.Queue[Callable[[], None]] = queue.Queue(MAX_CHANGES)
        try:
            self._change.note_unfinished()
        except WeldgateError as error:
            log.error("changes of the previous run cannot be checked: %s", error)
        self._threads = [
            threading.Thread(target=self._run, name="requests", daemon=True),
            threading.Thread(target=self._make_changes, name="settings", daemon=True),
        ]
        for thread in self._threads:
            thread.start()

    def on_event(self, event: Event) -> None:
        """Remember the last status of the cycle."""
        if isinstance(event, StatusEvent):
            self._status = event

    def _counts(self) -> Counts | None:
        return None if self._status is None else self._status.line.counts

    def _recipe(self) -> int:
        return 1 if self._status is None else self._status.recipe

    def _run(self) -> None:
        while not self._stop.is_set():
            self._check_ins.expect("requests", IDLE_S)
            try:
                self._serve_once()
            except Exception:  # a faulty request must not affect other windows
                log.exception("requests could not be served")
        self._desk.close()
        self._check_ins.rest("requests")

    def _serve_once(self) -> None:
        for incoming in self._server.received(POLL_S):
            reply = partial(self._reply, incoming.sender)
            self._desk.handle(incoming.message, reply, self._queue_change, source=str(incoming.peer))
        while not self._answers.empty():
            self._server.answer(*self._answers.get())
        self._desk.tick()

    def _reply(self, sender: int, answer: Answer) -> None:
        """Queue an answer, from either thread; the socket belongs to one of them."""
        self._answers.put((sender, answer))

    def _queue_change(self, who: str, message: Message, reply: Reply) -> None:
        try:
            self._changes.put_nowait(partial(self._make_change, who, message, reply))
        except queue.Full:
            raise WeldgateError(TOO_MANY) from None

    def _make_changes(self) -> None:
        while not self._stop.is_set():
            try:
                change = self._changes.get(timeout=POLL_S)
            except queue.Empty:
                continue
            with self._check_ins.working("settings", PATIENCE_S + IDLE_S):
                change()

    def _make_change(self, who: str, message: Message, reply: Reply) -> None:
        request, refusal = message.request, FAULT
        try:
            if isinstance(request, ChangeSettings):
                self._change.make(who, request.values, request.reason)
            elif isinstance(request, ReloadSettings):
                self._change.reload(who)
            refusal = ""
        except WeldgateError as error:
            refusal = str(error)
        except Exception:  # the next change must be possible
            log.exception("settings were not changed")
        reply(Answer(message.request_id, refusal, logged_in=True))

    def close(self) -> None:
        """End all logins and both threads."""
        self._stop.set()
        for thread in self._threads:
            thread.join(timeout=10)
