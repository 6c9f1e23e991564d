"""The section [plc]: connection, access, certificates and times of the handshake."""

from typing import Any, Literal

from pydantic import Field, model_validator

from station.register_windows import COMMAND_START, COMMAND_WORDS, STATUS_START, STATUS_WORDS
from station.settings.address import Networks, Port
from station.settings.section import FilePath, Section

Preset = Literal["codesys", "twincat", "openplc", "tia"]
"""Tool with which the PLC's program is made."""
PRESETS: dict[str, dict[str, int]] = {
    "codesys": {"command_base": 0, "status_base": 0, "command_function": 4},
    "twincat": {"command_base": 12288, "status_base": 12388},
    "openplc": {"command_base": 1024, "status_base": 1124},
    "tia": {"command_base": 0, "status_base": 100},
}
"""Addresses of the windows in the memory that a PLC's Modbus server offers, by tool.

CODESYS Modbus TCP Server Device: the PLC's outputs are input registers, its inputs holding registers.
TwinCAT TF6250: register 12288 is %MB0. OpenPLC: register 1024 is %MW0. TIA MB_SERVER: a global data block
without optimised access, of which word 0 is register 0.
"""


S7_PORT = 102
"""TCP port of S7 PLCs."""


class TlsSettings(Section):
    """Certificates for Modbus/TCP Security; `weldgate certificates` makes some for tests."""

    certificate_path: FilePath
    key_path: FilePath
    ca_path: FilePath
    """Certificate of the authority whose certificates are trusted."""
    crl_path: FilePath | None = None
    """Revocation list of the authority; None: no certificate counts as revoked."""
    writer_role: str | None = Field(default=None, min_length=1)
    """Role that a client's certificate must have to write (server); None: any, or none."""


class S7Settings(Section):
    """Access to the memory of a Siemens PLC in its own protocol, S7 over ISO on TCP, instead of Modbus."""

    db: int = Field(ge=1, le=65535)
    """Number of the data block that holds the windows; not optimised."""
    rack: int = Field(default=0, ge=0, le=7)
    slot: int = Field(default=1, ge=0, le=31)
    """Slot of the CPU: 1 for S7-1200 and S7-1500, 2 for S7-300, as configured for S7-400."""


class PlcSettings(Section):
    """Connection to the PLC: address, access and times of the handshake."""

    mode: Literal["server", "client"] = "server"
    """server: the PLC accesses the registers of the station; client: the station accesses those of the
    PLC."""
    host: str = "127.0.0.1"
    """Address of the station (server) or of the PLC (client)."""
    port: Port = 1502
    unit: int = Field(default=1, ge=0, le=255)
    preset: Preset | None = None
    """Tool of the PLC's program, which decides addresses and function where they are not set (client)."""
    command_base: int = Field(default=COMMAND_START, ge=0, le=65536 - COMMAND_WORDS)
    """Address of the command window in the PLC (client)."""
    command_function: Literal[3, 4] = 3
    """Function that reads the command window: holding registers (3) or input registers (4) (client)."""
    status_base: int = Field(default=STATUS_START, ge=0, le=65536 - STATUS_WORDS)
    """Address of the status window in the PLC (client)."""
    poll_ms: int = Field(default=20, ge=5, le=1000)
    timeout_ms: int = Field(default=400, ge=50, le=5000)
    """Time allowed for the response to one request (client)."""
    low_word_first: bool = False
    """True if 32-bit values start with their low word; the test pattern shows whether that is right."""
    allow: Networks = ()
    """Networks from which peers can connect (server); empty: all."""
    writers: Networks = ()
    """Networks from which peers can write (server); empty: all that can connect."""
    writer_idle_ms: int = Field(default=2_000, ge=100, le=600_000)
    """Time without a write after which another peer can take over the right to write (server)."""
    tls: TlsSettings | None = None
    s7: S7Settings | None = None
    """Speak S7 instead of Modbus (client); addresses then count the words of the data block, from 0."""
    deadline_ms: int = Field(default=2000, ge=100, le=60_000)
    """Time from trigger to result; a later result is ERROR."""
    result_ttl_ms: int = Field(default=10_000, ge=100, le=600_000)
    """Time after which an unread result is cleared."""
    stuck_ms: int = Field(default=5_000, ge=100, le=600_000)
    """Time after which a bit that the PLC holds counts as stuck."""
    plc_heartbeat_ms: int = Field(default=2_000, ge=0, le=60_000)
    """Time within which PLC_HEARTBEAT must change; 0: not monitored."""

    @model_validator(mode="before")
    @classmethod
    def _preset_filled_in(cls, values: Any) -> Any:
        preset = values.get("preset") if isinstance(values, dict) else None
        if preset not in PRESETS:
            return values  # absent, or refused by its type
        if values.get("mode") != "client":
            raise ValueError('preset: only for mode = "client"; a PLC that is the client needs none')
        return PRESETS[preset] | values

    @model_validator(mode="before")
    @classmethod
    def _s7_fits(cls, values: Any) -> Any:
        if not isinstance(values, dict) or values.get("s7") is None:
            return values
        if values.get("mode") != "client":
            raise ValueError('s7: only for mode = "client"; the station does not act as an S7 PLC')
        beside = [name for name in ("tls", "preset", "command_function", "unit") if name in values]
        if beside:
            raise ValueError(f"{beside[0]}: only for Modbus; leave it out beside s7")
        return {"port": S7_PORT} | values

    @model_validator(mode="after")
    def _windows_apart(self) -> "PlcSettings":
        if self.command_function == 4:  # the windows lie in two tables
            return self
        command = range(self.command_base, self.command_base + COMMAND_WORDS)
        status = range(self.status_base, self.status_base + STATUS_WORDS)
        if command.start < status.stop and status.start < command.stop:
            sizes = f"windows of {COMMAND_WORDS} and {STATUS_WORDS} registers overlap"
            raise ValueError(f"command_base {command.start} and status_base {status.start}: {sizes}")
        return self
