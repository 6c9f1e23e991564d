from collections.abc import Iterator

import pytest

from deploy.demo.ports import free_ports
from station.plc.line import ModbusLine, make_line
from station.plc.map.registers import Offline
from station.plc.port import Health
from station.settings.model import PlcSettings


@pytest.fixture
def line() -> Iterator[ModbusLine]:
    """A healthy station that is a server; the right to write is soon free for the next peer."""
    kept = make_line(PlcSettings(port=free_ports(1)[0], plc_heartbeat_ms=0, writer_idle_ms=100))
    kept.start()
    kept.check_in(Health(ready=True, offline=Offline.NONE, failure=False, config_crc=7))
    yield kept
    kept.stop()
