"""Modbus TCP on the wire: server, client, framing, access and TLS."""
