"""Service mode as this window asks for it: a lease that is renewed until the user ends it or logs out."""

from functools import partial

from PySide6.QtCore import QObject, QTimer, Signal

from station.channel.requests import TOO_OLD, Answer, EndService, HoldService
from station.panel.session.account import Account
from station.panel.session.pending import NO_CONNECTION

RENEW_MS = 1000
"""Interval at which service mode is renewed."""


class ServiceClient(QObject):
    """Asks for service mode and renews it while it is granted."""

    changed = Signal()
    """Emitted when service mode was granted or has ended."""
    refused = Signal(str)
    """Carries why the engine does not grant service mode, or has ended it."""

    def __init__(self, account: Account) -> None:
        super().__init__()
        self._account = account
        self._held: HoldService | None = None
        self._renew = QTimer(self)
        self._renew.timeout.connect(self._renew_now)
        account.changed.connect(self._drop)

    @property
    def held(self) -> HoldService | None:
        """Request that the engine has granted to this window, or None."""
        return self._held

    def hold(self, request: HoldService) -> None:
        """Ask for service mode, or for other settings of it; `changed` or `refused` follows."""
        self._account.ask(request, partial(self._on_answer, request))

    def adjust(self, exposure_us: float, gain_db: float) -> None:
        """Take setup images with this exposure and gain from the next renewal on."""
        if self._held is not None and self._held.look:
            self._held = HoldService(look=True, exposure_us=exposure_us, gain_db=gain_db)

    def end(self) -> None:
        """End service mode, so that the station continues."""
        if self._held is not None:
            self._account.ask(EndService(), lambda _: None)
            self._drop()

    def _renew_now(self) -> None:
        if self._held is not None:
            self._account.ask(self._held, self._on_renewed)

    def _on_answer(self, request: HoldService, answer: Answer) -> None:
        if answer.done and self._account.user is not None:
            self._held = request
            self._renew.start(RENEW_MS)
            self.changed.emit()
        elif not answer.done:
            self.refused.emit(answer.refusal)

    def _on_renewed(self, answer: Answer) -> None:
        if self._held is not None and answer.refusal not in ("", NO_CONNECTION, TOO_OLD):
            self._drop()
            self.refused.emit(answer.refusal)

    def _drop(self) -> None:
        """Forget the lease: the engine has ended it, or ends it with the login."""
        self._renew.stop()
        if self._held is not None:
            self._held = None
            self.changed.emit()

    def close(self) -> None:
        """Stop renewing service mode."""
        self._renew.stop()
