"""A map with a ninth bit of CONTROL, a fourth flag and one more register in each window; run as a module.

The sources of the map are changed before anything imports them, as somebody who adds these would change them.
Then every place that handles bits or sizes is asked.
"""

import asyncio
import sys
import time
from collections.abc import Callable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def change(name: str, *changes: tuple[str, str]) -> None:
    """Import a module from its source with changes."""
    path = ROOT / f"{name.replace('.', '/')}.py"
    source = path.read_text()
    for before, after in changes:
        assert source.count(before) == 1, f"{path}: {before!r} must be there once; adapt this test"
        source = source.replace(before, after)
    spec = spec_from_file_location(name, path)
    assert spec is not None
    module = module_from_spec(spec)
    sys.modules[name] = module
    exec(compile(source, path, "exec"), module.__dict__)


change(
    "station.register_windows",
    ("\nCOMMAND_WORDS =", "\nCOMMAND_WORDS = 1 +"),
    ("\nSTATUS_WORDS =", "\nSTATUS_WORDS = 1 +"),
)
change(
    "station.plc.map.registers",
    ("    ABORT = 128\n", "    ABORT = 128\n    NINTH = 256\n"),
    ("    DRIFT = 4\n", "    DRIFT = 4\n    FOURTH = 8\n"),
    (
        "\nBY_NAME = ",
        '\nMAP += (Register(COMMAND_START + COMMAND_WORDS - 1, "MORE", "u16", "more"),)'
        '\nMAP += (Register(STATUS_START + STATUS_WORDS - 1, "LAST", "u16", "last"),)\nBY_NAME = ',
    ),
)

import pytest  # noqa: E402
from pydantic import TypeAdapter  # noqa: E402

from deploy.demo.ports import free_ports  # noqa: E402
from station.plc.block.dialects import structured_text  # noqa: E402
from station.plc.bus_log import edges  # noqa: E402
from station.plc.handshake_state import State  # noqa: E402
from station.plc.line import make_line  # noqa: E402
from station.plc.map.document import as_markdown  # noqa: E402
from station.plc.map.registers import COMMAND_WORDS, STATUS_START, STATUS_WORDS, Control, Flags, Value  # noqa: E402
from station.plc.port import LineState  # noqa: E402
from station.plc.simulated.line import SimulatedLine  # noqa: E402
from station.plc.wire.modbus import ModbusClient  # noqa: E402
from station.settings.model import PlcSettings  # noqa: E402

NINTH, FOURTH = Control["NINTH"], Flags["FOURTH"]
SIZES = f"windows of {COMMAND_WORDS} and {STATUS_WORDS} registers"


def handshake() -> None:
    """The handshake begins with all bits held, the ninth among them: no edge at the start."""
    assert NINTH in State().control


def line() -> None:
    """A bit and a register that a PLC writes reach the handshake and the bus recorder."""
    looks: list[dict[str, Value]] = []
    settings = PlcSettings(port=free_ports(1)[0])
    station = make_line(settings, lambda _time, command, _status: looks.append(command))

    async def write() -> None:
        client = ModbusClient("127.0.0.1", station.port)
        await client.connect()
        await client.write(0, [0] * COMMAND_WORDS)
        await client.write(0, [int(NINTH), *[0] * (COMMAND_WORDS - 2), 4711])
        assert len(await client.read(STATUS_START, STATUS_WORDS)) == STATUS_WORDS
        until = time.monotonic() + 10
        while looks[-1]["MORE"] != 4711 and time.monotonic() < until:
            await asyncio.sleep(0.01)
        client.close()

    assert NINTH in station._inputs(0.0, True, None).control, "all bits count as held until the PLC is heard"
    station.start()
    try:
        asyncio.run(write())
        assert station._inputs(0.0, True, None).control == station.state().control == NINTH
        channel = TypeAdapter(LineState)
        assert channel.validate_json(channel.dump_json(station.state())).control == NINTH, "for the window"
    finally:
        station.stop()
    assert looks[-1]["MORE"] == 4711


def bus() -> None:
    """The bus recorder has an edge of it."""
    status: dict[str, Value] = {"STATUS": 0, "OFFLINE_REASON": 0}
    found = edges(0.0, ({"CONTROL": 0}, {"CONTROL": int(NINTH)}), (status, status))
    assert [edge.name for edge in found] == ["NINTH"]


def simulated() -> None:
    """The simulated PLC reads the flag."""
    plc = SimulatedLine.at("127.0.0.1", 1, accept_simulated=True)
    flags = int(FOURTH | Flags.NOVEL)
    seen: dict[str, Value] = {"VERDICT": 1, "INSPECTION_ID": 1, "REASON": 0, "FLAGS": flags}
    assert plc._answer(seen, 1.0).flags == FOURTH | Flags.NOVEL


def documents() -> None:
    """The printed map and the PLC's block have the new sizes."""
    assert f"Clients may write registers 0 to {COMMAND_WORDS - 1} only" in as_markdown()
    assert "| 8 | NINTH |" in as_markdown()
    assert f"Window : ARRAY[0..{STATUS_WORDS - 1}]" in structured_text()
    assert f"Command : ARRAY[0..{COMMAND_WORDS - 1}]" in structured_text()


def settings() -> None:
    """The settings refuse windows that overlap by one register, and one that ends beyond the last address."""
    apart = {"mode": "client", "status_base": 1000}
    refused = (
        (1000 - COMMAND_WORDS + 1, f"{SIZES} overlap"),
        (65536 - COMMAND_WORDS + 1, "less than or equal to"),
    )
    for base, said in refused:
        with pytest.raises(ValueError, match=said):
            PlcSettings.model_validate(apart | {"command_base": base})
    PlcSettings.model_validate(apart | {"command_base": 1000 - COMMAND_WORDS})


PLACES: tuple[Callable[[], None], ...] = (handshake, line, bus, simulated, documents, settings)

if __name__ == "__main__":
    for place in PLACES:
        place()
        print(place.__name__)
