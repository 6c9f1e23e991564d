import asyncio
import socket
from collections.abc import Callable, Coroutine
from ipaddress import ip_network
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.errors import LineError
from station.plc.wire.access import Access, WriteRight, admitted
from station.plc.wire.admission import MAX_CLIENTS, MAX_NEWCOMERS
from station.plc.wire.modbus import ModbusClient, ModbusServer

ALLOW = (ip_network("192.168.7.0/24"), ip_network("10.0.0.5"), ip_network("fd00::/8"))


@pytest.mark.parametrize(
    ("address", "welcome"),
    [
        ("192.168.7.9", True),
        ("192.168.8.9", False),
        ("10.0.0.5", True),
        ("::ffff:10.0.0.5", True),
        ("fd00::1%eth0", True),
        ("fe80::1", False),
    ],
)
def test_only_listed_peers_may_connect(address: str, welcome: bool) -> None:
    assert admitted(address, ALLOW) is welcome
    assert admitted(address, ())


@given(st.lists(st.tuples(st.integers(1, 4), st.floats(0, 2), st.booleans()), max_size=40))
def test_nobody_writes_beside_the_holder_nor_takes_its_place_while_it_connects_again(
    events: list[tuple[int, float, bool]],
) -> None:
    """Connections 1 and 2 come from one address, 3 and 4 from another."""
    right, now, holder, last, wrote = WriteRight(1.0), 0.0, None, None, -10.0
    for connection, wait_s, leaves in events:
        now += wait_s
        address = "plc" if connection <= 2 else "other"
        idle = now - wrote > 1.0
        if leaves:
            right.drop(connection)
            holder = None if holder == connection else holder
        elif right.take(connection, address, now):
            assert holder == connection or idle or (holder is None and last in (None, address))
            holder, last, wrote = connection, address, now
        else:
            assert not idle
            assert holder != connection
            assert holder is not None or last != address


def serve(conversation: Callable[[ModbusServer], Coroutine[Any, Any, None]], **options: Any) -> None:
    async def run() -> None:
        server = ModbusServer("127.0.0.1", 0, words=200, writable=range(100), **options)
        await server.start()
        try:
            await conversation(server)
        finally:
            await server.stop()

    asyncio.run(run())


def test_a_second_writer_is_refused_until_the_first_is_gone_or_silent() -> None:
    async def conversation(server: ModbusServer) -> None:
        one, two = ModbusClient("127.0.0.1", server.port), ModbusClient("127.0.0.1", server.port)
        await one.connect()
        await two.connect()
        await one.write(0, [1])
        with pytest.raises(LineError, match="exception_code=6"):
            await two.write(0, [2])
        assert await server.read(0, 1) == [1]
        await two.connect()
        assert await two.read(0, 1) == [1], "others may read"
        one.close()
        await asyncio.sleep(0.05)
        await two.write(0, [3])
        await one.connect()
        await asyncio.sleep(1.1)
        await one.write(0, [4])
        assert await server.read(0, 1) == [4]
        one.close()
        two.close()

    serve(conversation, access=Access(writer_idle_s=1.0))


def test_a_peer_that_is_not_on_the_list_is_turned_away() -> None:
    async def conversation(server: ModbusServer) -> None:
        client = ModbusClient("127.0.0.1", server.port, timeout_s=0.3)
        await client.connect()  # the system accepts, the server hangs up
        with pytest.raises(LineError):
            await client.read(0, 1)
        client.close()

    serve(conversation, access=Access(allow=(ip_network("192.0.2.0/24"),)))


def test_connections_that_only_sit_there_make_room() -> None:
    async def conversation(server: ModbusServer) -> None:
        idle = await asyncio.to_thread(
            lambda: [socket.create_connection(("127.0.0.1", server.port)) for _ in range(MAX_NEWCOMERS + 8)]
        )
        client = ModbusClient("127.0.0.1", server.port)
        await client.connect()
        assert await client.read(0, 2) == [0, 0]
        client.close()
        for peer in idle:
            peer.close()

    serve(conversation)


def test_who_has_just_connected_is_not_the_one_that_was_silent_longest() -> None:
    async def conversation(server: ModbusServer) -> None:
        readers = [ModbusClient("127.0.0.1", server.port) for _ in range(MAX_CLIENTS)]
        for reader in readers:
            await reader.connect()
            await reader.read(0, 1)
        newcomers = [await asyncio.open_connection("127.0.0.1", server.port) for _ in range(9)]
        for number, (reader_, writer) in enumerate(newcomers):
            writer.write(bytes([0, number, 0, 0, 0, 6, 1, 3, 0, 0, 0, 1]))
            assert (await reader_.readexactly(11))[1] == number
            writer.close()
            await writer.wait_closed()
        for reader in readers:
            reader.close()

    serve(conversation)


def test_requests_in_one_packet_are_answered_in_order_each_under_its_own_number() -> None:
    async def conversation(server: ModbusServer) -> None:
        await server.write(0, list(range(200)))
        reader, writer = await asyncio.open_connection("127.0.0.1", server.port)
        writer.write(b"".join(bytes([0, n, 0, 0, 0, 6, 1, 3, 0, n, 0, 1]) for n in range(1, 11)))
        answers = await reader.readexactly(10 * 11)
        assert [answers[i * 11 + 1] for i in range(10)] == list(range(1, 11))
        assert [answers[i * 11 + 10] for i in range(10)] == list(range(1, 11))
        writer.close()
        await writer.wait_closed()

    serve(conversation)


def test_a_request_that_comes_byte_by_byte_is_answered() -> None:
    async def conversation(server: ModbusServer) -> None:
        reader, writer = await asyncio.open_connection("127.0.0.1", server.port)
        for byte in bytes([0, 1, 0, 0, 0, 6, 1, 3, 0, 0, 0, 1]):
            writer.write(bytes([byte]))
            await asyncio.sleep(0.002)
        assert len(await reader.readexactly(11)) == 11
        writer.close()
        await writer.wait_closed()

    serve(conversation)
