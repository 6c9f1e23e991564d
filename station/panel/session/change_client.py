"""Asks the engine to change settings: it alone checks, notes, writes and uses them."""

from collections.abc import Sequence

from PySide6.QtCore import QObject, Signal

from station.channel.requests import Answer, Changed, ChangeSettings
from station.panel.session.account import Account


class ChangeClient(QObject):
    """One change after the other; pages show that it is waited for."""

    asked = Signal()
    used = Signal()
    """The station goes by the changed settings."""
    refused = Signal(str)
    """Nothing was changed, and why."""

    def __init__(self, account: Account) -> None:
        super().__init__()
        self._account, self._waiting = account, False

    @property
    def waiting(self) -> bool:
        """True while the engine has not answered."""
        return self._waiting

    def make(self, values: Sequence[Changed], reason: str) -> None:
        """Ask for a change; `used` or `refused` follows. Does nothing while another one is waited for."""
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
