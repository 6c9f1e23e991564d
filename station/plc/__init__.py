"""The connection to the PLC of the line: register map, handshake and Modbus."""
