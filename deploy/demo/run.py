"""`weldgate-demo`: runs the whole station against a simulated line, with an emulated camera.

The station runs unmodified in its own process, with the camera and Modbus code of production.
"""

import argparse
import asyncio
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

import cv2
import numpy as np
from rich.console import Console

from deploy.demo.ports import free_ports
from deploy.demo.station import SERIAL, running, shipped_parts, station_toml
from deploy.demo.summary import DemoPart, Judged, count, print_part, summarise, write_json
from station.errors import LineError, WeldgateError
from station.files.destination import find_destination, output_path, standard_output_free
from station.files.installation import room_command
from station.numbers import number_option, whole_option
from station.plc.simulated.line import SimulatedLine
from synth.camera.feed import Feed
from synth.errors import SynthError

RENDER_PATIENCE_S = 120.0
DEADLINE_MS = 8000
"""Time for a part: the demo is to judge on any machine, not to be fast."""
"""Maximum time to wait for one rendered part."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the demo and return its exit code.

    The code is 0 if every part was judged and there was no escape, 1 if not, 2 if the demo could not run.
    """
    parser = argparse.ArgumentParser(
        prog="weldgate-demo",
        description="Run the whole station against a simulated line, on rendered parts of known truth.",
    )
    parser.add_argument("--headless", action="store_true", help="open no window, even if there is a display")
    parser.add_argument(
        "--parts", type=whole_option, default=24, metavar="N", help="number of parts (default: %(default)s)"
    )
    parser.add_argument("--json", type=output_path, metavar="FILE", help="write the results as JSON")
    parser.add_argument(
        "--records",
        type=Path,
        default=Path("demo-records"),
        metavar="DIR",
        help="write the records to this archive folder (default: %(default)s)",
    )
    parser.add_argument(
        "--seed",
        type=whole_option,
        default=7,
        metavar="N",
        help="seed of the parts that are rendered in addition to the shipped frames (default: %(default)s)",
    )
    parser.add_argument(
        "--pace",
        type=number_option,
        default=0.0,
        metavar="S",
        help="seconds between parts (default: 2 with a window, no pause without)",
    )
    arguments = parser.parse_args(argv)
    if arguments.parts < 1:
        parser.error("--parts must be at least 1")
    try:
        if arguments.json is not None:
            find_destination(arguments.json).check()
    except FileNotFoundError:
        parser.error(f"--json {arguments.json}: the folder does not exist")
    except OSError as error:
        parser.error(f"--json {arguments.json}: cannot be written ({error.strerror})")
    try:
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
        with standard_output_free([arguments.json]):
            return _run(arguments, Console())
    except (WeldgateError, SynthError, OSError) as error:
        print(f"weldgate-demo: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


def _run(arguments: argparse.Namespace, console: Console) -> int:
    window = not arguments.headless and _has_display()
    pace_s = arguments.pace or (2.0 if window else 0.0)
    records = arguments.records.resolve()
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="weldgate-")))
        feed = Feed(folder / "feed", SERIAL)
        ports = free_ports(4)
        settings = folder / "station.toml"
        settings.write_text(station_toml(records, *ports, deadline_ms=DEADLINE_MS))
        log = stack.enter_context((folder / "engine.log").open("w"))
        fresh = max(0, arguments.parts - len(shipped_parts()))
        renderer = stack.enter_context(_renderer(folder / "fresh", fresh, arguments.seed)) if fresh else None
        environment = {**os.environ, **feed.environment}
        engine = stack.enter_context(
            running([*room_command("station"), "engine", "-c", str(settings)], environment, log)
        )
        if window:
            panel_log = stack.enter_context((folder / "panel.log").open("w"))
            panel = stack.enter_context(
                running([*room_command("station"), "panel", "-c", str(settings)], dict(os.environ), panel_log)
            )
            time.sleep(1.0)
            if panel.poll() is not None:
                reason = _last_line(folder / "panel.log")
                console.print(f"[yellow]window could not be opened, continuing without it: {reason}[/]")
        stopping = threading.Event()
        parts = _parts(
            arguments.parts, folder / "fresh", renderer=renderer, console=console, stopping=stopping
        )
        judged = asyncio.run(
            _drive(
                ports[0],
                feed,
                parts,
                stopping=stopping,
                engine=engine,
                log=folder / "engine.log",
                pace_s=pace_s,
                console=console,
            )
        )
    summarise(judged, records, console)
    if arguments.json is not None:
        write_json(arguments.json, judged, records)
    return 0 if count(judged).good and len(judged) == arguments.parts else 1


def _has_display() -> bool:
    return sys.platform in ("win32", "darwin") or bool(
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    )


@contextmanager
def _renderer(out: Path, count: int, seed: int) -> "Iterator[subprocess.Popen[bytes]]":
    render = [*room_command("synth"), "part", "--out", str(out), "--count", str(count), "--seed", str(seed)]
    with running(render, dict(os.environ), subprocess.DEVNULL) as process:
        yield process


def _parts(
    count: int,
    fresh: Path,
    *,
    renderer: "subprocess.Popen[bytes] | None",
    console: Console,
    stopping: threading.Event,
) -> Iterator[DemoPart]:
    """Yield the shipped frames, then rendered frames as they become ready."""
    shipped = shipped_parts()[:count]
    yield from shipped
    seen: set[str] = set()
    total = count - len(shipped)

    def unseen() -> list[Path]:
        return sorted(path for path in (fresh / "frames").glob("part_*.json") if path.stem not in seen)

    while len(seen) < total:
        waited_s = time.monotonic()
        with console.status(f"rendering part {len(seen) + 1} of {total}") as status:
            while not (ready := unseen()):
                dead = renderer is None or renderer.poll() is not None
                late = stopping.is_set() or time.monotonic() - waited_s > RENDER_PATIENCE_S
                if late or (dead and not unseen()):
                    raise SynthError(
                        "the renderer stopped; run 'weldgate-synth part --out DIR --count 1' to see why"
                    )
                status.update(f"rendering part {len(seen) + 1} of {total}  {_bar(len(seen), total)}")
                time.sleep(0.05)
        for path in ready:
            seen.add(path.stem)
            yield DemoPart(path.stem, path.with_suffix(".png"), json.loads(path.read_text())["truth"])


def _bar(done: int, total: int) -> str:
    filled = round(20 * done / total)
    return "█" * filled + "░" * (20 - filled)


async def _drive(
    port: int,
    feed: Feed,
    parts: Iterator[DemoPart],
    *,
    stopping: threading.Event,
    engine: "subprocess.Popen[bytes]",
    log: Path,
    pace_s: float,
    console: Console,
) -> list[Judged]:
    line = SimulatedLine.at("127.0.0.1", port, accept_simulated=True)
    judged: list[Judged] = []
    try:
        up = False
        while (part := await line.meanwhile(asyncio.to_thread(next, parts, None))) is not None:
            image = cv2.imread(str(part.path), cv2.IMREAD_GRAYSCALE)
            if image is None:
                raise SynthError(f"{part.path}: not a readable image; restore it from the repository")
            feed.show(np.asarray(image, np.uint8))
            if not up:
                await _bring_up(line, engine, log)
                up = True
            if engine.poll() is not None:
                raise WeldgateError(f"the engine stopped: {_last_line(log)}")
            judged.append(Judged(part, await line.inspect(part.name, DEADLINE_MS / 1000 + 2)))
            print_part(judged, console)
            await line.meanwhile(asyncio.sleep(pace_s))
    finally:
        stopping.set()
        await line.close()
    return judged


async def _bring_up(line: SimulatedLine, engine: "subprocess.Popen[bytes]", log: Path) -> None:
    until = time.monotonic() + 30.0
    while True:
        try:
            await line.connect(timeout_s=0.0)
            break
        except LineError:
            if engine.poll() is not None or time.monotonic() > until:
                raise WeldgateError(f"the engine did not start: {_last_line(log)}") from None
            await asyncio.sleep(0.1)
    if not await line.wait_ready(15.0):
        raise WeldgateError(f"the engine did not become ready: {_last_line(log)}")


def _last_line(log: Path) -> str:
    lines = [line for line in log.read_text(errors="replace").splitlines() if line.strip()]
    return lines[-1] if lines else "its log is empty"


if __name__ == "__main__":
    sys.exit(main())
