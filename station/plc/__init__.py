"""The line behind one port: register map, handshake, Modbus."""
