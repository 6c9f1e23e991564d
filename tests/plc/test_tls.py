"""Modbus/TCP Security: both sides show a certificate, and who has none gets nothing."""

import asyncio
import ssl
import stat
from pathlib import Path

import pytest

from deploy.demo.ports import free_ports
from station.__main__ import main
from station.errors import LineError, SettingsError
from station.plc.line import make_line
from station.plc.map.registers import Offline
from station.plc.port import Health
from station.plc.simulated.line import SimulatedLine
from station.plc.simulated.windows import RemoteWindows
from station.plc.wire.certificates import make_certificates
from station.plc.wire.modbus import ModbusClient
from station.plc.wire.tls import client_context, server_context
from station.settings.model import PlcSettings, TlsSettings


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("certificates")
    make_certificates(made, "127.0.0.1", 7)
    return made


def settings(folder: Path, side: str) -> TlsSettings:
    return TlsSettings(
        certificate_path=folder / f"{side}.pem", key_path=folder / f"{side}.key", ca_path=folder / "ca.pem"
    )


def test_a_plc_with_a_certificate_is_served_and_others_are_not(folder: Path, tmp_path: Path) -> None:
    make_certificates(tmp_path / "other", "127.0.0.1", 7)
    line = make_line(PlcSettings(port=free_ports(1)[0], tls=settings(folder, "server"), plc_heartbeat_ms=0))
    line.start()
    line.check_in(Health(ready=True, offline=Offline.NONE, failure=False, config_crc=7))

    async def ready(tls: ssl.SSLContext | None) -> bool:
        plc = SimulatedLine(
            RemoteWindows(lambda: ModbusClient("127.0.0.1", line.port, timeout_s=0.5, tls=tls)), False
        )
        try:
            await plc.connect(0.0)
            return await plc.wait_ready(1.0)
        except LineError:
            return False
        finally:
            await plc.close()

    try:
        assert asyncio.run(ready(client_context(settings(folder, "client"))))
        assert not asyncio.run(ready(None)), "plain Modbus"
        assert not asyncio.run(ready(client_context(settings(tmp_path / "other", "client")))), (
            "another authority"
        )
        nobody = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        nobody.load_verify_locations(folder / "ca.pem")
        assert not asyncio.run(ready(nobody)), "no certificate"
    finally:
        line.stop()


def test_certificates_that_cannot_be_used_are_said_before_anything_runs(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="file not found"):
        server_context(settings(tmp_path, "server"))
    wrong = TlsSettings(
        certificate_path=folder / "server.pem", key_path=folder / "client.key", ca_path=folder / "ca.pem"
    )
    with pytest.raises(SettingsError, match="certificate, key or authority cannot be used"):
        make_line(PlcSettings(tls=wrong))


def test_keys_are_for_their_owner_alone_and_nothing_is_written_over(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert all(stat.S_IMODE(path.stat().st_mode) == 0o600 for path in folder.glob("*.key"))
    before = (folder / "ca.pem").read_bytes()
    assert main(["certificates", str(folder)]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert (folder / "ca.pem").read_bytes() == before
    assert main(["certificates", str(tmp_path / "new"), "--host", "station.local"]) == 0
    assert len(list((tmp_path / "new").iterdir())) == 5
    assert main(["certificates", str(tmp_path / "never"), "--days", "0"]) == 2
    assert not (tmp_path / "never").exists()
