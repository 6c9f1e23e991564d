"""Every page of the window in both languages and both themes, from a demo run of the real station.

Run under a display; `make screenshots` brings its own (Xvfb).
"""

import argparse
import asyncio
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from threading import Thread

import cv2
import numpy as np
from PySide6.QtCore import QEventLoop, QTimer
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication

from deploy.demo.ports import free_ports
from deploy.demo.station import running, shipped_parts, station_toml
from station.channel.requests import HoldService
from station.journal.accounts import save_user
from station.journal.review_writer import give
from station.journal.reviews import Opinion
from station.journal.users import Level
from station.panel.app import open_window
from station.panel.pages.table import PageKey
from station.panel.window import Window
from station.plc.simulated.line import SimulatedLine
from synth.camera.feed import Feed

PARTS = 12
VIEWS: tuple[tuple[str, PageKey, int], ...] = (
    ("live", PageKey.LIVE, 0),
    ("live-segment", PageKey.LIVE, 0),
    ("history", PageKey.HISTORY, 0),
    ("statistics", PageKey.STATISTICS, 0),
    ("line", PageKey.LINE, 0),
    ("alarms", PageKey.ALARMS, 0),
    ("setup-login", PageKey.SETUP, 0),
    ("setup-camera", PageKey.SETUP, 1),
    ("setup-recipe", PageKey.SETUP, 2),
    ("setup-masters", PageKey.SETUP, 3),
    ("setup-users", PageKey.SETUP, 4),
    ("setup-journal", PageKey.SETUP, 5),
    ("replay", PageKey.REPLAY, 0),
)


def main(argv: Sequence[str] | None = None) -> int:
    """Write PNG files; 0 if all were written."""
    parser = argparse.ArgumentParser(prog="screenshots", description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("screenshots"), help="default: %(default)s")
    parser.add_argument("--size", default="1280x800", metavar="WxH", help="default: %(default)s")
    parser.add_argument(
        "--views", nargs="+", choices=[name for name, _, _ in VIEWS], default=[name for name, _, _ in VIEWS]
    )
    arguments = parser.parse_args(argv)
    width, height = (int(number) for number in arguments.size.split("x"))
    arguments.out.mkdir(parents=True, exist_ok=True)
    app = QApplication.instance() or QApplication(sys.argv[:1])  # noqa: F841 - must live
    with tempfile.TemporaryDirectory(prefix="weldgate-") as name, _station(Path(name)) as (settings, drive):
        window = open_window(settings)
        window.resize(width, height)
        window.show()
        _people(window)
        line = Thread(target=drive)
        line.start()
        _wait(line.is_alive, still=True)
        _reviews(window)
        for theme in ("dark", "light"):
            for language in ("en", "de"):
                window.dress(theme)
                window.speak(language)
                for view, page, tab in VIEWS:
                    if view in arguments.views:
                        _show(window, view, page, tab)
                        _save(window, arguments.out / f"{view}-{language}-{theme}.png")
        window.close()
    print(arguments.out)
    return 0


@contextmanager
def _station(folder: Path) -> Iterator[tuple[Path, Callable[[], None]]]:
    """An engine in its own process; its settings, and what passes parts through it."""
    feed, ports = Feed(folder / "feed"), free_ports(4)
    settings = folder / "station.toml"
    settings.write_text(
        station_toml(folder / "records", *ports)
        + '[golden]\ndue_h = 8\n[golden.masters]\n"MASTER-OK" = "OK"\n"MASTER-NOK" = "NOK"\n'
    )
    command = [sys.executable, "-m", "station", "engine", "-c", str(settings)]
    with (folder / "engine.log").open("w") as log, running(command, {**os.environ, **feed.environment}, log):

        async def parts() -> None:
            line = SimulatedLine.at("127.0.0.1", ports[0], accept_simulated=True)
            await line.connect()
            shipped = shipped_parts()
            order = [shipped[i % len(shipped)] for i in range(PARTS)]
            nok = next(part for part in shipped if part.truth != "OK")
            masters = [("MASTER-OK", next(part for part in shipped if part.truth == "OK"), True)]
            for serial, part, golden in [
                *masters,
                *((f"CELL-{i:05d}", p, False) for i, p in enumerate(order, 1)),
                ("CELL-00013", nok, False),
            ]:
                feed.show(np.asarray(cv2.imread(str(part.path), cv2.IMREAD_GRAYSCALE), np.uint8))
                await line.inspect(serial, golden=golden)
                await line.meanwhile(asyncio.sleep(0.15))
            await line.close()

        yield settings, lambda: asyncio.run(parts())


def _people(window: Window) -> None:
    folder = window.session.received.folder
    _wait(lambda: folder.is_dir())
    for name, level, pin in (
        ("Ada Admin", Level.ADMIN, "1234"),
        ("Quentin Quality", Level.QUALITY, "2345"),
        ("Sam Setter", Level.SETTER, "3456"),
    ):
        save_user(folder, "Ada Admin", name, level, pin)


def _reviews(window: Window) -> None:
    folder, nok = (
        window.session.received.folder,
        [part.record for part in window.session.received.parts if part.record.verdict == "NOK"],
    )
    for number in [record.inspection_id for record in nok[-2:]]:
        give(
            folder,
            "Quentin Quality",
            may_second=True,
            inspection_id=number,
            verdict="NOK",
            opinion=Opinion.RIGHT,
            comment="seen under the microscope",
        )
        give(folder, "Ada Admin", may_second=True, inspection_id=number, verdict="NOK", opinion=Opinion.RIGHT)


def _show(window: Window, view: str, page: PageKey, tab: int) -> None:
    """Bring a page to where it has something to show."""
    window.go(page)
    session = window.session
    if view.startswith("setup") and session.account.user is None and view != "setup-login":
        session.account.log_in("Ada Admin", "1234", lambda _: None)
        _wait(lambda: session.account.user is not None)
    shown = window.page
    if page is PageKey.SETUP:
        shown.tabs.setCurrentIndex(tab)  # type: ignore[attr-defined]
    if view == "history":
        shown.fields.verdict.setCurrentIndex(2)  # type: ignore[attr-defined]
    if view == "live-segment":
        shown.strip.touched.emit(18)  # type: ignore[attr-defined]
    if view == "replay":
        shown.judge.click()  # type: ignore[attr-defined]
        _wait(lambda: shown.done is not None)  # type: ignore[attr-defined]
        shown.table.selectRow(shown.table.rowCount() - 1)  # type: ignore[attr-defined]
        _wait(lambda: shown.weld.drawn is not None)  # type: ignore[attr-defined]
    if view == "statistics":
        _wait(lambda: shown.summary is not None)  # type: ignore[attr-defined]
    if view == "setup-camera":
        session.service.hold(HoldService(look=True))
        _wait(lambda: shown.camera.weld.drawn is not None)  # type: ignore[attr-defined]
    if view == "setup-recipe":
        recipe = shown.recipe  # type: ignore[attr-defined]
        recipe.fields["limits.hole.min_mm"].set(1.5)
        recipe.segments.set({2: 0.02})
        recipe.ask.click()
        _wait(lambda: bool(recipe.message.text()))
    _pause(0.6)
    if view == "setup-camera":
        session.service.end()
        _wait(lambda: session.received.status is not None and not session.received.status.service)


def _save(window: Window, path: Path) -> None:
    picture = window.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)  # must outlive its pixels
    pixels = np.frombuffer(picture.constBits(), np.uint8)
    rows = pixels.reshape(picture.height(), -1)[:, : picture.width() * 3].reshape(
        picture.height(), picture.width(), 3
    )
    cv2.imwrite(str(path), np.ascontiguousarray(rows[:, :, ::-1]), [cv2.IMWRITE_PNG_COMPRESSION, 9])


def _wait(until: Callable[[], bool], still: bool = False, patience_s: float = 60.0) -> None:
    """Let the window live until something is so, or, `still`, no longer so."""
    end = time.monotonic() + patience_s
    while until() is still:
        if time.monotonic() > end:
            raise TimeoutError("the demo run did not come so far")
        _pause(0.05)


def _pause(seconds: float) -> None:
    loop = (
        QEventLoop()
    )  # not QApplication.processEvents: in PySide6 6.12 it drops a reference to None each time
    QTimer.singleShot(int(seconds * 1000), loop.quit)
    loop.exec()


if __name__ == "__main__":
    sys.exit(main())
