"""Translates the texts of the window: English is in the code, German in weldgate_de.ts.

`make translations` brings the German up to date.
"""

from pathlib import Path

from PySide6.QtCore import QCoreApplication, QLibraryInfo, QLocale, QTranslator

LANGUAGES = {"en": "English", "de": "Deutsch"}
"""Languages of the window, each with its own name for itself."""
FOLDER = Path(__file__).resolve().parents[1] / "languages"
"""Folder of the translations."""
_used: list[QTranslator] = []
_language = ["en"]


def translate(context: str, text: str) -> str:
    """Return a text of the window in the language in use."""
    return QCoreApplication.translate(context, text)


def data(text: object) -> str:
    """Return a word of the station, such as a kind of defect or an alarm, in the language in use.

    `deploy.docs.window_words` collects these words for the translators; an unknown text is returned as it is.
    """
    return QCoreApplication.translate("data", str(text))


def language() -> str:
    """Return the language in use: a key of `LANGUAGES`."""
    return _language[0]


def use(name: str) -> None:
    """Use another language from now on; texts that are already on the screen do not change."""
    app = QCoreApplication.instance()
    if app is None:
        raise RuntimeError("no application to translate")
    while _used:
        app.removeTranslator(_used.pop())
    _language[0] = name
    QLocale.setDefault(QLocale(name))
    if name == "en":
        return
    of_qt = QLibraryInfo.path(QLibraryInfo.LibraryPath.TranslationsPath)
    for file, folder in ((f"weldgate_{name}", str(FOLDER)), (f"qtbase_{name}", of_qt)):
        translator = QTranslator()
        if translator.load(file, folder):
            app.installTranslator(translator)
            _used.append(translator)
