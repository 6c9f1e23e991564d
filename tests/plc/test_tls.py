"""Modbus/TCP Security: both sides show a certificate, and who has none gets nothing."""

import asyncio
import socket
import ssl
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from ipaddress import IPv4Network
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from deploy.demo.ports import free_ports
from station.__main__ import main
from station.errors import LineError, SettingsError
from station.plc.line import ModbusLine, make_line
from station.plc.map.registers import Offline
from station.plc.port import Health
from station.plc.simulated.line import SimulatedLine
from station.plc.simulated.windows import RemoteWindows
from station.plc.wire.admission import MAX_NEWCOMERS
from station.plc.wire.certificates import make_certificates
from station.plc.wire.modbus import ModbusClient
from station.plc.wire.role import role_of
from station.plc.wire.tls import client_context, server_context
from station.settings.model import PlcSettings, TlsSettings
from tests.plc.authority import Authority


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
    with pytest.raises(SettingsError, match="certificate, key, authority or revocation list cannot be used"):
        make_line(PlcSettings(tls=wrong))


@contextmanager
def running(tls: TlsSettings, allow: tuple[IPv4Network, ...] = ()) -> Iterator[ModbusLine]:
    line = make_line(PlcSettings(port=free_ports(1)[0], tls=tls, plc_heartbeat_ms=0, allow=allow))
    line.start()
    try:
        yield line
    finally:
        line.stop()


def connects(line: ModbusLine, tls: ssl.SSLContext) -> str:
    """Return what a client gets: "written", "read" (it may not write), or "nothing"."""

    async def run() -> str:
        client = ModbusClient("127.0.0.1", line.port, timeout_s=5, tls=tls)
        try:
            await client.connect()
            await client.read(0, 1)
            try:
                await client.write(0, [1])
            except LineError:
                return "read"
            return "written"
        except LineError:
            return "nothing"
        finally:
            client.close()

    return asyncio.run(run())


@pytest.mark.parametrize(
    ("changes", "side", "gets"),
    [
        ({}, "client", "written"),
        ({}, "server", "nothing"),
        ({"writer_role": "Operator"}, "client", "written"),
        ({"writer_role": "Engineer"}, "client", "read"),
    ],
)
def test_the_certificate_decides_who_connects_and_who_writes(
    changes: dict[str, str], side: str, gets: str, folder: Path
) -> None:
    with running(settings(folder, "server").model_copy(update=changes)) as line:
        assert connects(line, client_context(settings(folder, side))) == gets


def test_a_certificate_without_a_use_passes_but_not_that_of_the_server_itself(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """Certificates of a plant often name no use; then the server's own one would pass as a client's."""
    plant = Authority(tmp_path / "plant")
    station, plc = plant.issue("station"), plant.issue("plc")
    with running(station) as line:
        assert connects(line, client_context(plc)) == "written"
        assert connects(line, client_context(station)) == "nothing"
    assert "the client shows the server's own certificate" in caplog.text


def test_a_revoked_certificate_is_refused(tmp_path: Path) -> None:
    plant = Authority(tmp_path / "plant")
    station, plc, old = (plant.issue(name) for name in ("station", "plc", "old"))
    with running(station.model_copy(update={"crl_path": plant.revoke(old)})) as line:
        assert connects(line, client_context(plc)) == "written"
        assert connects(line, client_context(old)) == "nothing"


def test_handshakes_that_never_end_make_room_and_strangers_get_none(
    folder: Path, caplog: pytest.LogCaptureFixture
) -> None:
    def flooded(allow: tuple[IPv4Network, ...]) -> str:
        with running(settings(folder, "server"), allow) as line:
            address = ("127.0.0.1", line.port)
            idle = [socket.create_connection(address) for _ in range(MAX_NEWCOMERS + 20)]
            try:
                return connects(line, client_context(settings(folder, "client")))
            finally:
                for peer in idle:
                    peer.close()

    assert flooded(()) == "written"
    assert "sent no request while others waited" in caplog.text
    caplog.clear()
    assert flooded((IPv4Network("192.0.2.0/24"),)) == "nothing"
    assert "is not on the list plc.allow" in caplog.text
    assert "TLS" not in caplog.text, "refused before any handshake"


@given(st.binary(max_size=300))
def test_noise_has_no_role(noise: bytes) -> None:
    """A certificate is checked before its role is read; still nothing breaks the reading."""
    assert role_of(noise) is None or b"\x0c" in noise


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
