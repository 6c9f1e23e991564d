"""A station without hardware: shipped frames, settings with the emulated camera, and its processes."""

import json
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from deploy.demo.summary import DemoPart
from station.files.installation import ROOMS_FOLDER, SHIPPED_NETWORKS

SHIPPED_FRAMES = ROOMS_FOLDER / "deploy" / "frames"
"""Lot of rendered frames that is shipped with weldgate."""
SERIAL = "0815-0000"
"""Serial number of the emulated camera."""


def shipped_parts() -> list[DemoPart]:
    """Return the rendered frames that are shipped with weldgate."""
    labels = json.loads((SHIPPED_FRAMES / "labels.json").read_text())["frames"]
    return [
        DemoPart(Path(item["frame"]).stem, SHIPPED_FRAMES / item["frame"], item["truth"]) for item in labels
    ]


def station_toml(
    records: Path,
    port: int,
    *,
    host: str = "127.0.0.1",
    deadline_ms: int = 2000,
    preset: str | None = None,
) -> str:
    """Return the settings of a station with the emulated camera and the shipped networks.

    `host` and `port` are the address for the PLC, or, with a `preset`, that of a PLC which is the server. A
    busy machine needs a longer deadline.
    """
    client = "" if preset is None else f'mode = "client"\npreset = "{preset}"\n'
    good = next(part.path for part in shipped_parts() if part.truth == "OK")
    return f"""
[camera]
kind = "pylon"
device_class = "BaslerCamEmu"
serial = "{SERIAL}"
timeout_ms = {deadline_ms // 4}
[model]
path = {json.dumps(str(SHIPPED_NETWORKS / "weldgate.onnx"))}
ring_path = {json.dumps(str(SHIPPED_NETWORKS / "ring.onnx"))}
seen_path = {json.dumps(str(SHIPPED_NETWORKS / "seen.onnx"))}
self_test_path = {json.dumps(str(good))}
self_test_verdict = "OK"
[plc]
host = {json.dumps(host)}
port = {port}
{client}deadline_ms = {deadline_ms}
[archive]
folder = {json.dumps(str(records))}
"""


@contextmanager
def running(
    command: list[str], environment: dict[str, str], log: object
) -> "Iterator[subprocess.Popen[bytes]]":
    """Start a process and stop it at the end."""
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
