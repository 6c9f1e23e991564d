"""A port that was handed out stays free until its server starts, however many processes ask for ports."""

import asyncio
import socket
from contextlib import closing

import pytest

from deploy.demo.ports import RESERVED, free_ports
from station.plc.map.registers import STATUS_START, STATUS_WORDS
from station.plc.wire.modbus import ModbusServer


def _take(port: int) -> None:
    with closing(socket.socket()) as taker:
        taker.bind(("127.0.0.1", port))


def test_a_free_port_is_kept_from_others_and_open_to_a_server() -> None:
    (port,) = free_ports(1)
    with pytest.raises(OSError, match="in use"):
        _take(port)
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", port), timeout=5)

    async def serve() -> None:
        words = STATUS_START + STATUS_WORDS
        server = ModbusServer("127.0.0.1", port, words=words, writable=range(STATUS_START, words))
        await server.start()
        await server.stop()

    asyncio.run(serve())
    free_ports(RESERVED)
    _take(port)
