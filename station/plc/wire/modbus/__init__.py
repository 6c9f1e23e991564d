"""Modbus TCP server and client; the only folder that imports pymodbus."""

import logging

from station.plc.wire.modbus.client import ModbusClient as ModbusClient
from station.plc.wire.modbus.server import ModbusServer as ModbusServer

logging.getLogger("pymodbus").setLevel(logging.CRITICAL)
