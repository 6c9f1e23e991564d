"""Modbus TCP client: registers of another machine."""

from contextlib import suppress

from pymodbus.client import AsyncModbusTcpClient
from pymodbus.exceptions import ModbusException
from pymodbus.transport import CommParams, CommType

from station.errors import LineError
from station.plc.wire.modbus.closing import close_at_once
from station.plc.wire.tls import Tls


class _Client(AsyncModbusTcpClient):
    """pymodbus' client, plain or over TLS; unlike its own TLS client, it sends the MBAP header."""

    def __init__(self, host: str, port: int, timeout_s: float, tls: Tls) -> None:
        self.comm_params = CommParams(
            comm_type=CommType.TCP if tls is None else CommType.TLS,
            host=host,
            port=port,
            sslctx=tls,
            comm_name="client",
            reconnect_delay=0.0,
            reconnect_delay_max=0.0,
            timeout_connect=timeout_s,
        )
        super().__init__("", retries=0)


class ModbusClient:
    """Registers of another machine; a request that is not answered in time closes the connection."""

    def __init__(
        self, host: str, port: int, *, unit: int = 1, timeout_s: float = 1.0, tls: Tls = None
    ) -> None:
        self._host, self._port, self._unit, self._timeout_s, self._tls = host, port, unit, timeout_s, tls
        self._address = f"{host}:{port}"
        self._client: AsyncModbusTcpClient | None = None

    async def connect(self) -> None:
        """Open a new connection. Raises LineError if nothing answers."""
        self.close()
        client = _Client(self._host, self._port, self._timeout_s, self._tls)
        connected = False
        with suppress(OSError, ModbusException):
            connected = await client.connect()
        if not connected:
            close_at_once(client.ctx)
            raise LineError(f"no Modbus server at {self._address}; check that it runs, and the firewall")
        self._client = client

    async def read(self, address: int, count: int, function: int = 3) -> list[int]:
        """Return up to 125 words in one read of holding (3) or input registers (4). Raises LineError."""
        try:
            client = self._open()
            ask = client.read_input_registers if function == 4 else client.read_holding_registers
            response = await ask(address, count=count, device_id=self._unit)
        except ModbusException as error:
            raise self._lost(f"read: {error}") from None
        if response.isError() or len(response.registers) != count:
            raise self._lost(f"read of {count} registers at {address} refused: {response}")
        return list(response.registers)

    async def write(self, address: int, words: list[int]) -> None:
        """Write up to 123 words at once. Raises LineError; then it is unknown whether the peer has them."""
        try:
            response = await self._open().write_registers(address, words, device_id=self._unit)
        except ModbusException as error:
            raise self._lost(f"write: {error}") from None
        if response.isError():
            raise self._lost(f"write of {len(words)} registers at {address} refused: {response}")

    def _open(self) -> AsyncModbusTcpClient:
        if self._client is None or not self._client.connected:
            raise self._lost("the connection is closed")
        return self._client

    def _lost(self, why: str) -> LineError:
        self.close()
        return LineError(f"{self._address}: {why}")

    def close(self) -> None:
        """Close the connection."""
        if self._client is not None:
            close_at_once(self._client.ctx)
            self._client = None
