"""Closes a connection at once."""

import asyncio

from pymodbus.transaction import TransactionManager


def close_at_once(connection: TransactionManager) -> None:
    """Close a connection at once, without waiting for a TLS peer that may have disappeared."""
    transport = connection.transport
    connection.close()
    if isinstance(transport, asyncio.WriteTransport):
        transport.abort()
