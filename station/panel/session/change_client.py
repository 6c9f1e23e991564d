"""Asks the engine to change settings; the engine checks, records, writes and uses them."""

from collections.abc import Sequence

from PySide6.QtCore import QObject, Signal

from station.channel.requests import Answer, Changed, ChangeSettings
from station.panel.session.account import Account


class ChangeClient(QObject):
    """Makes one change at a time; pages show while it is waited for."""

    asked = Signal()
    """Emitted when a change was sent to the engine."""
    used = Signal()
    """Emitted when the changed settings are in use."""
    refused = Signal(str)
    """Carries why nothing was changed."""

    def __init__(self, account: Account) -> None:
        super().__init__()
        self._account, self._waiting = account, False

    @property
    def waiting(self) -> bool:
        """True while the engine has not answered to a change."""
        return self._waiting

    def make(self, values: Sequence[Changed], reason: str) -> None:
        """Ask for a change; `used` or `refused` follows. Do nothing while another change is waited for."""
        if self._waiting:
            return
        self._waiting = True
        self._account.ask(ChangeSettings(tuple(values), reason.strip()), self._on_answer)
        if self._waiting:
            self.asked.emit()

    def _on_answer(self, answer: Answer) -> None:
        self._waiting = False
        if answer.done:
            self.used.emit()
        else:
            self.refused.emit(answer.refusal)
