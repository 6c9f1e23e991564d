"""Words in the language in use. English stands in the code; German in weldgate_de.ts, made by `make translations`."""

from pathlib import Path

from PySide6.QtCore import QCoreApplication, QLibraryInfo, QLocale, QTranslator

LANGUAGES = {"en": "English", "de": "Deutsch"}
FOLDER = Path(__file__).resolve().parents[1] / "languages"
_used: list[QTranslator] = []
_language = ["en"]


def translate(context: str, text: str) -> str:
    """A text of the code in the language in use."""
    return QCoreApplication.translate(context, text)


def data(text: object) -> str:
    """A word of the station's own vocabulary: kinds, reasons, alarms; listed in `vocabulary`."""
    return QCoreApplication.translate("data", str(text))


def language() -> str:
    """The language in use."""
    return _language[0]


def use(name: str) -> None:
    """Speak another language; texts set before stay as they are."""
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
