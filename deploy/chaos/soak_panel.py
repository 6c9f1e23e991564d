"""Sends eight hours of events to the window in fast motion; its memory, widgets and threads must not grow."""

import argparse
import gc
import os
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from PySide6.QtCore import QEventLoop, QTimer
from PySide6.QtWidgets import QApplication

from deploy.demo.ports import free_ports
from deploy.demo.station import shipped_parts, station_toml
from station.archive.writer import Archive
from station.channel.events import PartEvent, Preview, StatusEvent
from station.channel.preview import make_preview
from station.channel.zeromq import Publisher
from station.domain import Frame, Origin
from station.files.image import read_image
from station.inspection.loading import prepare
from station.numbers import whole_option
from station.panel.app import open_window
from station.panel.pages.table import PAGES
from station.panel.window import Window
from station.plc.map.registers import (
    COMMAND_WORDS,
    STATUS_START,
    STATUS_WORDS,
    TEST_F32,
    TEST_U32,
    Control,
    Offline,
    Status,
    VerdictCode,
    pack_window,
)
from station.plc.port import Counts, LineState
from station.records import Part, Record
from station.settings.file import load
from station.settings.model import Settings

HOURS, PACE_S, STATUSES = 8, 2.0, 8
"""Duration that is simulated, seconds from part to part, and status events per part."""
ROUNDS = 10
"""Number of measurements."""


@dataclass(frozen=True, slots=True)
class Level:
    """Resources that the process uses."""

    memory_mb: float
    widgets: int
    threads: int
    files: int
    """Number of open files and sockets."""

    @staticmethod
    def now() -> "Level":
        """Return the current use of resources; works on Linux only."""
        gc.collect()
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        files = len(list(Path("/proc/self/fd").iterdir()))
        return Level(
            pages * os.sysconf("SC_PAGE_SIZE") / 1e6,
            len(QApplication.allWidgets()),
            threading.active_count(),
            files,
        )


def soak(folder: Path, parts: int) -> list[Level]:
    """Return the levels after each tenth of the parts; a QApplication must exist."""
    path = folder / "station.toml"
    path.write_text(station_toml(folder / "records", free_ports(1)[0]))
    settings = load(path)
    record, events = _made(settings)
    publisher = Publisher(settings.channel)
    window = open_window(path)
    window.show()
    levels: list[Level] = []
    try:
        for number in range(1, parts + 1):
            for status in events[0]:
                publisher.send(replace(status, at_s=time.monotonic()))
            part = replace(events[1], at_s=time.monotonic(), record=replace(record, inspection_id=number))
            publisher.send(part)
            if number % 10 == 0:
                publisher.show(replace(events[2], inspection_id=number))
            if number % 40 == 0:
                window.go(PAGES[number // 40 % len(PAGES)].key)
            if number % 10 == 0:
                _live(30)
            if number % (parts // ROUNDS) == 0:
                window.speak(
                    "de" if window.session.received.parts and number // (parts // ROUNDS) % 2 else "en"
                )
                for info in PAGES:
                    window.go(info.key)
                _until_received(window, number)
                levels.append(Level.now())
    finally:
        window.close()
        publisher.close()
    return levels


def _made(settings: Settings) -> tuple[Record, tuple[list[StatusEvent], PartEvent, Preview]]:
    """Return the record and the events of one real part."""
    loaded = prepare(settings, 1)
    image = read_image(shipped_parts()[0].path)
    archive = Archive(settings.archive)
    frame = Frame(image, datetime.now(UTC), "soak", Origin.SIMULATED)
    inspection = loaded.inspector.inspect(image)
    record = archive.commit(
        archive.begin(frame),
        inspection,
        Part("SOAK", 1, Origin.SIMULATED),
        loaded.provenance,
        now=frame.grabbed_at,
    )
    archive.close()
    words = tuple(
        pack_window(STATUS_START, STATUS_WORDS, {"TEST_U32": TEST_U32, "TEST_F32": TEST_F32, "COUNT_OK": 1})
    )
    now_s = time.monotonic()
    line = LineState(
        control=Control(0),
        status=Status(0),
        offline=Offline.NONE,
        error_code=0,
        counts=Counts(ok=1),
    )
    status = StatusEvent(
        at_s=now_s,
        started_s=now_s,
        camera_there=True,
        camera_message="",
        origin=Origin.SIMULATED,
        line=line,
        command_words=(0,) * COMMAND_WORDS,
        status_words=words,
    )
    part = PartEvent(
        at_s=now_s,
        record=record,
        novel=False,
        drift=None,
        reported=VerdictCode.NOK,
        record_ms=5.0,
        publish_ms=1.0,
    )
    preview = make_preview(1, image, inspection.ring, um_per_px=record.provenance.um_per_px)
    return record, ([status] * STATUSES, part, preview)


def _live(milliseconds: int) -> None:
    loop = QEventLoop()
    QTimer.singleShot(milliseconds, loop.quit)
    loop.exec()


def _until_received(window: Window, number: int) -> None:
    for _ in range(200):
        last = window.session.received.last
        if last is not None and last.record.inspection_id == number:
            return
        _live(20)
    raise TimeoutError("the window did not receive all parts")


def main(argv: Sequence[str] | None = None) -> int:
    """Print the levels; return 0 if they do not grow in the second half."""
    parser = argparse.ArgumentParser(
        prog="soak-panel", description="Send eight hours of events to the window in fast motion."
    )
    parser.add_argument(
        "--parts",
        type=whole_option,
        default=int(HOURS * 3600 / PACE_S),
        metavar="N",
        help="number of parts (default: %(default)s, which is eight hours)",
    )
    arguments = parser.parse_args(argv)
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    app = QApplication(sys.argv[:1])
    with tempfile.TemporaryDirectory(prefix="weldgate-") as name:
        levels = soak(Path(name), arguments.parts)
    for index, level in enumerate(levels, 1):
        print(
            f"{index * 10:3d} %  {level.memory_mb:6.1f} MB  {level.widgets} widgets  "
            f"{level.threads} threads  {level.files} files"
        )
    half, last = levels[len(levels) // 2 - 1], levels[-1]
    growth_mb = last.memory_mb - half.memory_mb
    print(f"second half: {growth_mb:+.1f} MB")
    app.quit()
    flat = (last.widgets, last.threads, last.files) <= (half.widgets, half.threads, half.files)
    return 0 if growth_mb < 5 and flat else 1


if __name__ == "__main__":
    sys.exit(main())
