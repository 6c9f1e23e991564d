"""Texts of the window into weldgate_de.ts, that into weldgate_de.qm. New texts are listed: translate them in the .ts file (Qt Linguist)."""

import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

PANEL = Path(__file__).resolve().parents[2] / "station" / "panel"
TS = PANEL / "languages" / "weldgate_de.ts"


def update(ts: Path) -> None:
    """Bring a .ts file up to the code; what it has translated stays."""
    sources = [str(path) for path in sorted(PANEL.rglob("*.py"))]
    _tool("lupdate", *sources, "-ts", str(ts), "-no-obsolete", "-locations", "none")


def release(ts: Path, qm: Path) -> None:
    """The binary file that the window reads."""
    _tool("lrelease", str(ts), "-qm", str(qm))


def untranslated(ts: Path) -> list[str]:
    """Texts that nobody has translated."""
    messages = ElementTree.parse(ts).getroot().iter("message")
    return [m.findtext("source") or "" for m in messages if not (m.findtext("translation") or "").strip()]


def _tool(name: str, *arguments: str) -> None:
    tool = Path(sys.executable).with_name(f"pyside6-{name}")
    done = subprocess.run([str(tool), *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{name}: {(done.stderr or done.stdout).strip().splitlines()[0]}")


def main() -> int:
    """0 if everything is translated."""
    update(TS)
    release(TS, TS.with_suffix(".qm"))
    missing = untranslated(TS)
    for text in missing:
        print(f"not translated: {text}")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
