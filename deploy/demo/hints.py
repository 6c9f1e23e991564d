"""What an integrator must know before the first part at the station of the demo."""

_BLOCK = (
    "  block: set AcceptSimulated := TRUE, or each part is refused with 12 (emulated camera)\n"
    "  block: copy CONFIG_CRC ({crc}) to Crc, or each part is refused with 9\n"
    "a new part lies in front of the camera at each trigger; Ctrl-C ends"
)


def server_hints(host: str, port: int) -> str:
    """Return the hints for a PLC that connects to the station."""
    return (
        f"station on {host}, port {port}: the PLC connects to it (Modbus TCP, any unit id)\n"
        "  command window: registers 0 to 22, status window: from 100; the first hour: deploy/plc/README.md\n"
        + _BLOCK.format(crc="register 112, Info.CONFIG_CRC")
    )


def client_hints(host: str, port: int) -> str:
    """Return the hints for a PLC that is the Modbus server."""
    return (
        f"the station connects to the PLC at {host}, port {port} (Modbus TCP, unit 1), and tries again until "
        "it answers\n" + _BLOCK.format(crc="Info.CONFIG_CRC")
    )
