"""A station that needs no hardware: shipped frames, settings with the emulated camera, processes that end again."""

import json
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from deploy.demo.summary import DemoPart
from station.files.installation import ROOMS_FOLDER, SHIPPED_NETWORKS

SHIPPED_FRAMES = ROOMS_FOLDER / "deploy" / "frames"
SERIAL = "0815-0000"
"""Serial number of the emulated camera."""


def shipped_parts() -> list[DemoPart]:
    """The few rendered frames that come with the project."""
    labels = json.loads((SHIPPED_FRAMES / "labels.json").read_text())["frames"]
    return [
        DemoPart(Path(item["frame"]).stem, SHIPPED_FRAMES / item["frame"], item["truth"]) for item in labels
    ]


def station_toml(
    records: Path, plc_port: int, events_port: int, preview_port: int, requests_port: int
) -> str:
    """Settings of a station with the emulated camera and the shipped networks."""
    good = next(part.path for part in shipped_parts() if part.truth == "OK")
    return f"""
[camera]
kind = "pylon"
device_class = "BaslerCamEmu"
serial = "{SERIAL}"
[model]
path = {json.dumps(str(SHIPPED_NETWORKS / "weldgate.onnx"))}
ring_path = {json.dumps(str(SHIPPED_NETWORKS / "ring.onnx"))}
self_test_path = {json.dumps(str(good))}
self_test_verdict = "OK"
[plc]
port = {plc_port}
deadline_ms = 3500  # a slow or busy machine needs it; the line's window is 4 s
[archive]
folder = {json.dumps(str(records))}
[channel]
events_port = {events_port}
preview_port = {preview_port}
requests_port = {requests_port}
"""


@contextmanager
def running(
    command: list[str], environment: dict[str, str], log: object
) -> "Iterator[subprocess.Popen[bytes]]":
    """A process that is ended afterwards."""
    process = subprocess.Popen(
        command, env=environment, stdout=log, stderr=subprocess.STDOUT, cwd=ROOMS_FOLDER
    )  # type: ignore[call-overload]
    try:
        yield process
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(timeout=10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
