"""Where to read from and write to. Nothing can be renamed or deleted there, and nothing comes of it once nobody is logged in any more."""

from pathlib import Path

from PySide6.QtWidgets import QFileDialog, QWidget

from station.journal.users import Level
from station.panel.session.session import Session


def ask_folder(parent: QWidget, session: Session, title: str) -> Path | None:
    """A folder, or None."""
    name = QFileDialog.getExistingDirectory(parent, title, options=QFileDialog.Option.ReadOnly)
    return Path(name) if name and session.account.may(Level.OPERATOR) else None


def ask_file(parent: QWidget, session: Session, title: str, suggestion: str) -> Path | None:
    """A file to write, with the suggestion's ending, or None; the dialog has asked whether one that exists may be replaced."""
    dialog = QFileDialog(parent, title)
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    dialog.setOption(QFileDialog.Option.ReadOnly)
    dialog.setDefaultSuffix(Path(suggestion).suffix)
    dialog.selectFile(suggestion)
    chosen = dialog.selectedFiles() if dialog.exec() else []
    dialog.deleteLater()
    return Path(chosen[0]) if chosen and session.account.may(Level.OPERATOR) else None
