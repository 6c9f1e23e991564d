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
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from rich.console import Console

from deploy.demo.alone import stand_alone
from deploy.demo.follow import follow_bus
from deploy.demo.hints import client_hints
from deploy.demo.ports import free_ports
from deploy.demo.stage import Stage, has_display, last_line, staged
from deploy.demo.station import running, shipped_parts, station_toml
from deploy.demo.summary import DemoPart, Judged, count, print_part, summarise, write_json
from station.errors import LineError, WeldgateError
from station.files.destination import find_destination, output_path, standard_output_free
from station.files.installation import room_command
from station.numbers import number_option, port_option, whole_option
from station.plc.simulated.line import SimulatedLine
from station.settings.plc import PRESETS
from synth.errors import SynthError

RENDER_PATIENCE_S = 120.0
"""Maximum time to wait for one rendered part."""
DEADLINE_MS = 8000
"""Time for a part: the demo is to judge on any machine, not to be fast."""
ALONE_DEADLINE_MS = 3000
"""Time for a part of a PLC, whose block waits 4 s."""


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
    parser.add_argument(
        "--station",
        action="store_true",
        help="run the station alone, to try a PLC against, until Ctrl-C: a new picture at each trigger",
    )
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        help="with --station: own address; 0.0.0.0 for all networks; with --preset: address of the PLC "
        "(default: %(default)s)",
    )
    parser.add_argument(
        "--port",
        type=port_option,
        default=1502,
        metavar="PORT",
        help="with --station: TCP port for the PLC; with --preset: that of the PLC (default: %(default)s)",
    )
    parser.add_argument(
        "--preset",
        choices=list(PRESETS),
        help="with --station: the PLC is the Modbus server; connect to it, with the addresses of this tool",
    )
    arguments = parser.parse_args(argv)
    if arguments.parts < 1:
        parser.error("--parts must be at least 1")
    if arguments.preset is not None and not arguments.station:
        parser.error("--preset: only with --station")
    try:
        if arguments.json is not None:
            find_destination(arguments.json).check()
    except FileNotFoundError:
        parser.error(f"--json {arguments.json}: the folder does not exist")
    except OSError as error:
        parser.error(f"--json {arguments.json}: cannot be written ({error.strerror})")
    try:
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
        # a shell that starts it in the background has it ignore Ctrl-C, and nothing else ends it
        signal.signal(signal.SIGINT, signal.default_int_handler)
        with standard_output_free([arguments.json]):
            console = Console()
            return _run_alone(arguments, console) if arguments.station else _run(arguments, console)
    except (WeldgateError, SynthError, OSError) as error:
        print(f"weldgate-demo: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


def _run(arguments: argparse.Namespace, console: Console) -> int:
    window = not arguments.headless and has_display()
    pace_s = arguments.pace or (2.0 if window else 0.0)
    records, port = arguments.records.resolve(), free_ports(1)[0]
    with ExitStack() as stack:
        settings = station_toml(records, port, deadline_ms=DEADLINE_MS)
        stage = stack.enter_context(staged(settings, window, console))
        folder = stage.folder
        fresh = max(0, arguments.parts - len(shipped_parts()))
        renderer = stack.enter_context(_renderer(folder / "fresh", fresh, arguments.seed)) if fresh else None
        stopping = threading.Event()
        parts = _parts(
            arguments.parts, folder / "fresh", renderer=renderer, console=console, stopping=stopping
        )
        judged = asyncio.run(
            _drive(
                port,
                stage,
                parts,
                stopping=stopping,
                pace_s=pace_s,
                console=console,
            )
        )
    summarise(judged, records, console)
    if arguments.json is not None:
        write_json(arguments.json, judged, records)
    return 0 if count(judged).good and len(judged) == arguments.parts else 1


def _run_alone(arguments: argparse.Namespace, console: Console) -> int:
    """Run the station without a line; Ctrl-C is its proper end."""
    settings = station_toml(
        arguments.records.resolve(),
        arguments.port,
        host=arguments.host,
        deadline_ms=ALONE_DEADLINE_MS,
        preset=arguments.preset,
    )
    try:
        with staged(settings, not arguments.headless and has_display(), console) as stage:
            if arguments.preset is None:
                asyncio.run(stand_alone(stage, arguments.host, arguments.port, console))
            else:
                console.print(client_hints(arguments.host, arguments.port), highlight=False, soft_wrap=True)
                follow_bus(stage, arguments.records.resolve(), console)
    except KeyboardInterrupt:
        console.print("the station has ended")
    return 0


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
    stage: Stage,
    parts: Iterator[DemoPart],
    *,
    stopping: threading.Event,
    pace_s: float,
    console: Console,
) -> list[Judged]:
    line = SimulatedLine.at("127.0.0.1", port, accept_simulated=True)
    judged: list[Judged] = []
    try:
        up = False
        while (part := await line.meanwhile(asyncio.to_thread(next, parts, None))) is not None:
            stage.show(part)
            if not up:
                await _bring_up(line, stage)
                up = True
            stage.check()
            judged.append(Judged(part, await line.inspect(part.name, DEADLINE_MS / 1000 + 2)))
            print_part(judged, console)
            await line.meanwhile(asyncio.sleep(pace_s))
    finally:
        stopping.set()
        await line.close()
    return judged


async def _bring_up(line: SimulatedLine, stage: Stage) -> None:
    until = time.monotonic() + 30.0
    while True:
        try:
            await line.connect(timeout_s=0.0)
            break
        except LineError:
            if stage.engine.poll() is not None or time.monotonic() > until:
                raise WeldgateError(f"the engine did not start: {last_line(stage.log)}") from None
            await asyncio.sleep(0.1)
    if not await line.wait_ready(15.0):
        raise WeldgateError(f"the engine did not become ready: {last_line(stage.log)}")


if __name__ == "__main__":
    sys.exit(main())
