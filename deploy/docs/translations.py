"""Brings weldgate_de.ts, the German of the window, up to date with the code, and makes the .qm file of it.

New texts are listed: translate them in the .ts file (Qt Linguist) and run this again.
"""

import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from deploy.docs.window_words import as_source, window_words

PANEL = Path(__file__).resolve().parents[2] / "station" / "panel"
TS = PANEL / "languages" / "weldgate_de.ts"


def update(ts: Path) -> None:
    """Bring a .ts file up to date with the code; existing translations stay."""
    with tempfile.TemporaryDirectory(prefix="weldgate-") as folder:
        words = Path(folder) / "words.py"
        words.write_text(as_source(window_words()), encoding="utf-8")
        sources = [str(path) for path in (*sorted(PANEL.rglob("*.py")), words)]
        _tool("lupdate", *sources, "-ts", str(ts), "-no-obsolete", "-locations", "none")


def release(ts: Path, qm: Path) -> None:
    """Write the binary file that the window reads."""
    _tool("lrelease", str(ts), "-qm", str(qm))


def untranslated(ts: Path) -> list[str]:
    """Return the texts that have no translation."""
    messages = ElementTree.parse(ts).getroot().iter("message")
    return [
        message.findtext("source") or ""
        for message in messages
        if not (message.findtext("translation") or "").strip()
    ]


def _tool(name: str, *arguments: str) -> None:
    tool = Path(sys.executable).with_name(f"pyside6-{name}")
    done = subprocess.run([str(tool), *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{name}: {(done.stderr or done.stdout).strip().splitlines()[0]}")


def main() -> int:
    """Update both files and list what is not translated. Return 0 if everything is translated, else 1."""
    update(TS)
    release(TS, TS.with_suffix(".qm"))
    missing = untranslated(TS)
    for text in missing:
        print(f"not translated: {text}")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
