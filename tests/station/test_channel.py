"""The channel between engine and windows: who gets in, and what one who is in can do to the others."""

import logging
import os
import re
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given
from hypothesis import strategies as st

from deploy.demo.ports import free_ports
from deploy.demo.station import station_toml
from station.channel.request_socket import (
    MAX_OF_PROCESS,
    MAX_WINDOWS,
    REQUESTS,
    RequestClient,
    RequestServer,
)
from station.channel.requests import EndService, LogIn, Message, StayLoggedIn
from station.channel.sockets import Peer
from station.channel.zeromq import EVENTS, PREVIEWS, Publisher, Subscriber
from station.errors import LineError
from station.journal.journal import Kind, entries
from station.journal.users import Level
from station.log import FORMAT, OneLine
from station.settings.model import ChannelSettings
from tests.desk import PIN, Desk, PlainWindow

NOBODY = 65534
"""Account of no one."""
ENDS = (Publisher, RequestServer, Subscriber, RequestClient)


@pytest.fixture
def folder() -> Iterator[Path]:
    """A folder that every account can reach, unlike those of pytest."""
    with TemporaryDirectory(prefix="weldgate-") as made:
        Path(made).chmod(0o755)
        yield Path(made) / "channel"


@pytest.fixture
def settings(folder: Path) -> ChannelSettings:
    return ChannelSettings(folder=folder)


@pytest.fixture
def desk(tmp_path: Path) -> Iterator[Desk]:
    path = tmp_path / "station.toml"
    path.write_text(station_toml(tmp_path / "records", free_ports(1)[0]))
    (tmp_path / "records").mkdir()
    made = Desk(path)
    made.knows("Quentin", Level.QUALITY)
    yield made
    made.close()


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can become another user")
def test_another_account_reaches_no_socket(settings: ChannelSettings) -> None:
    publisher, server = Publisher(settings), RequestServer(settings)
    code = (
        "import os, socket, sys\n"
        f"os.setgroups([]); os.setgid({NOBODY}); os.setuid({NOBODY})\n"
        "for path in sys.argv[1:]:\n"
        "    try:\n"
        "        kind = socket.SOCK_SEQPACKET if path.endswith('requests') else socket.SOCK_STREAM\n"
        "        socket.socket(socket.AF_UNIX, kind).connect(path)\n"
        "        print('let in', path)\n"
        "    except PermissionError:\n"
        "        pass\n"
    )
    paths = [str(settings.folder / name) for name in (EVENTS, PREVIEWS, REQUESTS)]
    assert all(Path(path).exists() for path in paths)
    try:
        done = subprocess.run(
            [sys.executable, "-c", code, *paths], capture_output=True, text=True, check=True
        )
    finally:
        server.close()
        publisher.close()
    assert done.stdout == ""


@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize("mode", [0o701, 0o704, 0o702, 0o755, 0o777, 0o1777])
def test_a_folder_that_everybody_may_enter_is_refused_by_both_ends(
    settings: ChannelSettings, end: type, mode: int
) -> None:
    settings.folder.mkdir()
    settings.folder.chmod(mode)
    with pytest.raises(LineError, match="chmod o-rwx"):
        end(settings)


@pytest.mark.parametrize("end", ENDS)
def test_a_folder_that_everybody_may_exchange_is_refused_by_both_ends(
    settings: ChannelSettings, end: type
) -> None:
    settings.folder.mkdir(mode=0o700)
    settings.folder.parent.chmod(0o777)
    with pytest.raises(LineError, match="may exchange"):
        end(settings)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a folder away")
def test_the_engine_refuses_the_folder_of_another_account(settings: ChannelSettings) -> None:
    settings.folder.mkdir(mode=0o700)
    os.chown(settings.folder, NOBODY, NOBODY)
    for end in (Publisher, RequestServer):
        with pytest.raises(LineError, match="belongs to another account"):
            end(settings)


def test_what_cannot_be_a_folder_of_sockets_is_said(folder: Path) -> None:
    folder.write_text("a file")
    for end in ENDS:
        with pytest.raises(LineError, match=r"channel\.folder"):
            end(ChannelSettings(folder=folder))
        with pytest.raises(LineError, match="shorter path"):
            end(ChannelSettings(folder=folder.parent / ("x" * 100)))


def test_sockets_of_a_killed_engine_are_used_again_and_those_of_a_running_one_are_not(
    settings: ChannelSettings,
) -> None:
    code = (
        "import sys, time, pathlib\n"
        "from station.channel.request_socket import RequestServer\n"
        "from station.settings.model import ChannelSettings\n"
        "kept = RequestServer(ChannelSettings(folder=pathlib.Path(sys.argv[1])))\n"
        "print('up', flush=True)\n"
        "time.sleep(1000)\n"
    )
    other = subprocess.Popen([sys.executable, "-c", code, str(settings.folder)], stdout=subprocess.PIPE)
    try:
        assert other.stdout is not None
        assert other.stdout.readline() == b"up\n"
        with pytest.raises(LineError, match="another engine uses"):
            RequestServer(settings)
        client = RequestClient(settings)
        os.kill(other.pid, signal.SIGKILL)
    finally:
        other.kill()
        other.communicate()
    server = RequestServer(settings)
    received = []
    end_s = time.monotonic() + 20
    while not received:
        assert time.monotonic() < end_s
        client.send(Message(1, time.monotonic(), EndService()))
        received = server.received(0.05)
    assert received[0].peer == Peer(os.geteuid(), os.getpid())
    client.close()
    server.close()


def test_the_journal_says_which_account_logged_in(desk: Desk) -> None:
    window = PlainWindow(desk.path)
    window.ask(LogIn("Quentin", "999999"))
    window.ask(LogIn("Quentin", PIN))
    window.close()
    here = f"user id {os.geteuid()}, process {os.getpid()}"
    found = entries(desk.active.settings.archive.folder, (Kind.LOGIN, Kind.LOGIN_FAILED))
    assert [(entry.kind, entry.reason) for entry in found] == [
        (Kind.LOGIN, here),
        (Kind.LOGIN_FAILED, here),
    ]


FLOOD = """
import socket, sys, time

def requests(size, count):
    peer = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 8_000_000)
    peer.settimeout(0.02)
    try:
        peer.connect(sys.argv[1])
        for _ in range(count):
            peer.send(b"x" * size)
    except OSError:
        pass
    return peer

def subscriptions(size, count):  # the greeting of ZeroMQ by hand: its own library sends nothing like that
    peer = socket.socket(socket.AF_UNIX)
    peer.settimeout(0.02)
    try:
        peer.connect(sys.argv[2])
        peer.sendall(b"\\xff" + bytes(8) + b"\\x7f\\x03\\0NULL" + bytes(48))
        peer.recv(64)
        peer.sendall(b"\\x04\\x19\\5READY\\x0bSocket-Type\\0\\0\\0\\3SUB")
        for _ in range(count):
            peer.sendall(b"\\x03" + size.to_bytes(8, "big") + b"\\1" * size)
    except OSError:
        pass
    return peer

print("up", flush=True)
kept = []
while True:
    kept = kept[-12:] + [requests(150_000, 10), requests(60_000, 40), requests(1, 2000)]
    kept += [subscriptions(3_200_000, 10), subscriptions(200, 2000)]
"""


def test_a_flood_of_large_messages_stalls_no_window(desk: Desk) -> None:
    settings = desk.active.settings.channel
    publisher = Publisher(settings)
    window = PlainWindow(desk.path)
    places = [str(settings.folder / name) for name in (REQUESTS, EVENTS)]
    flood = subprocess.Popen([sys.executable, "-c", FLOOD, *places], stdout=subprocess.PIPE)
    before_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    try:
        assert flood.stdout is not None
        assert flood.stdout.readline() == b"up\n"
        assert window.ask(LogIn("Quentin", PIN)).done
        end_s, asked = time.monotonic() + 3, 0
        while time.monotonic() < end_s:
            assert window.ask(StayLoggedIn(True)).done, "a request that waited too long would be refused"
            asked += 1
        assert flood.poll() is None
    finally:
        flood.kill()
        flood.communicate()
        window.close()
        publisher.close()
    assert asked >= 3
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kb < 300_000


def test_requests_are_read_at_a_limited_rate(settings: ChannelSettings) -> None:
    server, client = RequestServer(settings), RequestClient(settings)
    read, start_s = 0, time.monotonic()
    while time.monotonic() - start_s < 1.0:
        client.send(Message(1, time.monotonic(), EndService()))
        read += len(server.received(0.0))
    client.close()
    server.close()
    assert 0 < read <= 210


@given(st.text(), st.text())
def test_no_text_forges_an_entry_of_the_log(name: str, fault: str) -> None:
    try:
        raise ValueError(fault)
    except ValueError:
        record = logging.LogRecord("weldgate", logging.ERROR, "", 0, "login of %s", (name,), sys.exc_info())
    first, *others = OneLine(FORMAT).format(record).split("\n")
    assert first.isprintable()
    assert re.fullmatch(r"\d{4}-\d\d-\d\d .* ERROR login of .*", first)
    assert all(line.startswith("    | ") and line.isprintable() for line in others)
    assert others


def test_the_log_of_the_command_is_the_safe_one() -> None:
    code = (
        "import logging, station.log\n"
        "station.log.start_log()\n"
        "logging.getLogger('weldgate').error('login of %s', 'Ada\\n2026-01-01 INFO forged\\x1b[2J')\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert len(done.stderr.splitlines()) == 1
    assert r"Ada\n2026-01-01 INFO forged\x1b[2J" in done.stderr


def test_connections_are_limited_and_a_closed_one_makes_room(settings: ChannelSettings) -> None:
    server = RequestServer(settings)
    clients = [RequestClient(settings) for _ in range(MAX_OF_PROCESS + 1)]

    def served() -> set[int]:
        found: set[int] = set()
        end_s = time.monotonic() + 1.0
        while time.monotonic() < end_s:
            for number, client in enumerate(clients):
                client.send(Message(number, time.monotonic(), EndService()))
            found |= {incoming.message.request_id for incoming in server.received(0.01)}
        return found

    assert MAX_OF_PROCESS < MAX_WINDOWS
    assert len(served()) == MAX_OF_PROCESS
    clients.pop(0).close()
    assert len(served()) == MAX_OF_PROCESS
    for client in clients:
        client.close()
    server.close()
