"""Measures each step from trigger to RESULT_VALID, with the emulated camera."""

import argparse
import asyncio
import os
import sys
import tempfile
import threading
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from deploy.demo.ports import free_ports
from deploy.demo.station import SERIAL, shipped_parts
from station.archive.writer import Archive
from station.channel.events import Event, PartEvent
from station.engine.alarm_log import AlarmLog
from station.engine.listener import Listener
from station.engine.startup import make_cycle
from station.errors import WeldgateError
from station.files.image import read_image
from station.files.installation import SHIPPED_NETWORKS
from station.inspection.loading import prepare
from station.numbers import whole_option
from station.plc.line import make_line
from station.plc.simulated.line import Answer, SimulatedLine
from station.settings.model import Settings
from synth.camera.feed import Feed


def main(argv: Sequence[str] | None = None) -> int:
    """Pass parts through the whole station, and print median and p99 of each step."""
    parser = argparse.ArgumentParser(
        prog="bench-station",
        description="Measure each step from trigger to RESULT_VALID, with the emulated camera.",
    )
    parser.add_argument(
        "--parts", type=whole_option, default=100, metavar="N", help="number of parts (default: %(default)s)"
    )
    arguments = parser.parse_args(argv)
    if arguments.parts < 1:
        parser.error("--parts must be at least 1")
    with tempfile.TemporaryDirectory(prefix="weldgate-") as folder:
        try:
            answers, parts = measure(Path(folder), arguments.parts)
        except WeldgateError as error:
            print(f"bench-station: {error}", file=sys.stderr)
            return 2
    _print(answers, parts)
    return 0


def measure(folder: Path, count: int) -> tuple[list[Answer], list[PartEvent]]:
    """Judge `count` shipped frames, and return the results of the line and the events of the engine."""
    feed = Feed(folder / "feed", SERIAL)
    os.environ.update(feed.environment)
    settings = Settings.model_validate(
        {
            "camera": {"kind": "pylon", "device_class": "BaslerCamEmu", "serial": SERIAL},
            "model": {
                "path": SHIPPED_NETWORKS / "weldgate.onnx",
                "ring_path": SHIPPED_NETWORKS / "ring.onnx",
                "seen_path": SHIPPED_NETWORKS / "seen.onnx",
            },
            "archive": {"folder": folder / "records"},
            "plc": {"port": free_ports(1)[0]},
        }
    )
    events: list[Event] = []
    loaded = prepare(settings, 1)
    archive, line = Archive(settings.archive), make_line(settings.plc)
    line.start()
    alarm_log = AlarmLog(settings.archive.folder)
    listener = Listener(events.append, lambda _: None)
    cycle = make_cycle(settings, loaded, line=line, archive=archive, listener=listener, alarm_log=alarm_log)
    stop = threading.Event()
    thread = threading.Thread(target=cycle.run, args=(stop,), name="cycle")
    thread.start()
    try:
        answers = asyncio.run(_drive(line.port, feed, count))
    finally:
        stop.set()
        thread.join(timeout=10)
        line.stop()
        alarm_log.close()
        archive.close()
    return answers, [event for event in events if isinstance(event, PartEvent)]


async def _drive(port: int, feed: Feed, count: int) -> list[Answer]:
    images = [read_image(part.path) for part in shipped_parts()]
    line = SimulatedLine.at("127.0.0.1", port, accept_simulated=True)
    answers = []
    try:
        feed.show(images[0])
        await line.connect()
        for index in track(range(count), description="parts", transient=True):
            feed.show(images[index % len(images)])
            answers.append(await line.inspect(f"B{index}"))
    finally:
        await line.close()
    return answers


def _print(answers: list[Answer], parts: list[PartEvent]) -> None:
    timings = [part.record.inspection.timing for part in parts]
    rows = (
        ("grab", [timing.grab_ms for timing in timings]),
        ("locate", [timing.locate_ms for timing in timings]),
        ("unwrap and quality", [timing.unwrap_ms for timing in timings]),
        ("classify", [timing.classify_ms for timing in timings]),
        ("record", [part.record_ms for part in parts]),
        ("publish", [part.publish_ms for part in parts]),
        ("trigger to RESULT_VALID, seen by the line", [answer.trigger_to_valid_ms for answer in answers]),
    )
    table = Table(
        "step", "median ms", "p99 ms", title=f"{len(answers)} frames of 4200 x 2160, emulated camera"
    )
    for name, values in rows:
        known = [value for value in values if value is not None]
        table.add_row(name, f"{np.median(known):.1f}", f"{np.percentile(known, 99):.1f}")
    Console().print(table)


if __name__ == "__main__":
    sys.exit(main())
