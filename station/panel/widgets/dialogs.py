"""Dialogs that ask for a folder or a file.

Nothing can be renamed or deleted in them, and their answer is dropped if the user was logged out meanwhile.
"""

from pathlib import Path

from PySide6.QtWidgets import QFileDialog, QWidget

from station.journal.users import Level
from station.panel.session.session import Session


def ask_folder(parent: QWidget, session: Session, title: str) -> Path | None:
    """Return a folder, or None if none was chosen."""
    name = QFileDialog.getExistingDirectory(parent, title, options=QFileDialog.Option.ReadOnly)
    return Path(name) if name and session.account.may(Level.OPERATOR) else None


def ask_file(parent: QWidget, session: Session, title: str, suggestion: str) -> Path | None:
    """Return a file to write, or None if none was chosen.

    The file has the suffix of `suggestion`; the dialog has asked whether an existing file may be replaced.
    """
    dialog = QFileDialog(parent, title)
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    dialog.setOption(QFileDialog.Option.ReadOnly)
    dialog.setDefaultSuffix(Path(suggestion).suffix)
    dialog.selectFile(suggestion)
    chosen = dialog.selectedFiles() if dialog.exec() else []
    dialog.deleteLater()
    return Path(chosen[0]) if chosen and session.account.may(Level.OPERATOR) else None
