"""Writes images of all pages of the window, in both languages and themes, from a demo run of the station.

It needs a display; `make screenshots` brings its own (Xvfb).
"""

import argparse
import asyncio
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import cycle
from pathlib import Path
from threading import Event, Thread

import cv2
import numpy as np
from PySide6.QtCore import QEventLoop, QTimer
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication

from deploy.demo.ports import free_ports
from deploy.demo.station import running, shipped_parts, station_toml
from deploy.demo.summary import DemoPart
from station.channel.requests import HoldService
from station.journal.accounts import Accounts
from station.journal.review_writer import save_review
from station.journal.reviews import Opinion
from station.journal.users import Level
from station.panel.app import open_window
from station.panel.pages.table import PageKey
from station.panel.window import Window
from station.plc.simulated.line import SimulatedLine
from station.settings.keys import keys_folder
from synth.camera.feed import Feed

NOK_PLACES = (3, 7, 10)
"""Places of the NOK parts among `PARTS`; the last part, which is NOK too, comes after them."""
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
"""Views by name: page and number of its tab."""


def main(argv: Sequence[str] | None = None) -> int:
    """Write the images as PNG files. Return 0 if all were written."""
    parser = argparse.ArgumentParser(prog="screenshots", description=__doc__)
    parser.add_argument(
        "--out", type=Path, default=Path("screenshots"), help="write into this folder (default: %(default)s)"
    )
    parser.add_argument(
        "--size",
        default="1280x800",
        metavar="WxH",
        help="show the window in this size (default: %(default)s)",
    )
    names = [name for name, _, _ in VIEWS]
    parser.add_argument(
        "--views", nargs="+", choices=names, default=names, help="write these views only (default: all)"
    )
    arguments = parser.parse_args(argv)
    width, height = (int(number) for number in arguments.size.split("x"))
    arguments.out.mkdir(parents=True, exist_ok=True)
    app = QApplication.instance() or QApplication(sys.argv[:1])  # noqa: F841 - must live
    with (
        tempfile.TemporaryDirectory(prefix="weldgate-") as name,
        _station(Path(name)) as (settings, line),
    ):
        window = open_window(settings)
        window.resize(width, height)
        window.show()
        _save_users(window, settings)
        line.start()
        _wait(line.passed.is_set)
        _give_reviews(window)
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


class _Line(Thread):
    """A simulated line: passes parts, then keeps its heartbeat going until it is stopped."""

    def __init__(self, feed: Feed, port: int) -> None:
        super().__init__(name="line")
        self._feed, self._port = feed, port
        self.passed, self.stop = Event(), Event()

    def run(self) -> None:
        asyncio.run(self._run())

    async def _run(self) -> None:
        line = SimulatedLine.at("127.0.0.1", self._port, accept_simulated=True)
        await line.connect()
        for serial, part, golden in _order():
            self._feed.show(np.asarray(cv2.imread(str(part.path), cv2.IMREAD_GRAYSCALE), np.uint8))
            await line.inspect(serial, golden=golden)
            await line.meanwhile(asyncio.sleep(0.15))
        self.passed.set()
        while not self.stop.is_set():
            await line.meanwhile(asyncio.sleep(0.1))
        await line.close()


def _order() -> list[tuple[str, DemoPart, bool]]:
    """Return the parts in order, each with serial and whether it is a master: masters first, mostly OK."""
    shipped = shipped_parts()
    ok = next(part for part in shipped if part.truth == "OK")
    nok = [part for part in shipped if part.truth != "OK"]
    parts = [ok] * PARTS + [nok[0]]
    for place, part in zip(NOK_PLACES, cycle(nok), strict=False):
        parts[place] = part
    masters = [("MASTER-OK", ok, True), ("MASTER-NOK", nok[0], True)]
    return masters + [(f"CELL-{number:05d}", part, False) for number, part in enumerate(parts, 1)]


@contextmanager
def _station(folder: Path) -> Iterator[tuple[Path, _Line]]:
    """Run an engine in its own process; yield its settings file and its line, not yet started."""
    feed, port = Feed(folder / "feed"), free_ports(1)[0]
    settings = folder / "station.toml"
    settings.write_text(
        station_toml(folder / "records", port)
        + '[golden]\ndue_h = 8\n[golden.masters]\n"MASTER-OK" = "OK"\n"MASTER-NOK" = "NOK"\n'
    )
    command = [sys.executable, "-m", "station", "engine", "-c", str(settings)]
    line = _Line(feed, port)
    with (folder / "engine.log").open("w") as log, running(command, {**os.environ, **feed.environment}, log):
        try:
            yield settings, line
        finally:
            line.stop.set()
            if line.is_alive():
                line.join()


def _save_users(window: Window, settings: Path) -> None:
    folder = window.session.received.folder
    _wait(lambda: folder.is_dir())
    accounts = Accounts(folder, keys_folder(settings))
    for name, level, pin in (
        ("Ada Admin", Level.ADMIN, "123456"),
        ("Quentin Quality", Level.QUALITY, "234567"),
        ("Sam Setter", Level.SETTER, "3456"),
    ):
        accounts.save_user(name, level=level, pin=pin, by="Ada Admin")


def _give_reviews(window: Window) -> None:
    received = window.session.received
    folder = received.folder
    nok = [part.record.inspection_id for part in received.parts if part.record.verdict == "NOK"]
    for number in nok[-2:]:
        save_review(
            folder,
            "Quentin Quality",
            may_second=True,
            inspection_id=number,
            verdict="NOK",
            opinion=Opinion.RIGHT,
            comment="seen under the microscope",
        )
        save_review(
            folder, "Ada Admin", may_second=True, inspection_id=number, verdict="NOK", opinion=Opinion.RIGHT
        )


def _show(window: Window, view: str, page: PageKey, tab: int) -> None:
    """Show a page, with something on it to see."""
    window.go(page)
    session = window.session
    if view.startswith("setup") and session.account.user is None and view != "setup-login":
        session.account.log_in("Ada Admin", "123456", lambda _: None)
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
        _wait(lambda: recipe.released.rowCount() > 0)
    _pause(0.6)
    if view == "setup-camera":
        session.service.end()
        _wait(lambda: session.received.status is not None and not session.received.status.service)


def _save(window: Window, path: Path) -> None:
    image = window.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)  # must outlive its pixels
    pixels = np.frombuffer(image.constBits(), np.uint8)
    rows = pixels.reshape(image.height(), -1)[:, : image.width() * 3].reshape(
        image.height(), image.width(), 3
    )
    cv2.imwrite(str(path), np.ascontiguousarray(rows[:, :, ::-1]), [cv2.IMWRITE_PNG_COMPRESSION, 9])


def _wait(condition: Callable[[], bool], patience_s: float = 60.0) -> None:
    """Run the event loop of the window until a condition holds. Raises TimeoutError."""
    end_s = time.monotonic() + patience_s
    while not condition():
        if time.monotonic() > end_s:
            raise TimeoutError("The demo run has not got this far in time.")
        _pause(0.05)


def _pause(seconds: float) -> None:
    loop = QEventLoop()  # PySide6 6.12: each QApplication.processEvents drops a reference to None
    QTimer.singleShot(int(seconds * 1000), loop.quit)
    loop.exec()


if __name__ == "__main__":
    sys.exit(main())
