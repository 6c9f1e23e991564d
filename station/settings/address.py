"""Addresses in the settings: always a text, never one of the numbers that it stands for."""

from ipaddress import IPv4Address, IPv4Network, IPv6Address, IPv6Network
from typing import Annotated

from pydantic import AfterValidator, Field

from station.numbers import LAST_PORT
from station.settings.section import FROM_TEXT, TEXT_ONLY


def _loopback(address: IPv4Address | IPv6Address) -> IPv4Address | IPv6Address:
    if not address.is_loopback:
        raise ValueError("must be a loopback address of this machine, such as 127.0.0.1")
    return address


Port = Annotated[int, Field(ge=1, le=LAST_PORT)]
"""TCP port."""
Loopback = Annotated[
    Annotated[IPv4Address, FROM_TEXT] | Annotated[IPv6Address, FROM_TEXT],
    TEXT_ONLY,
    AfterValidator(_loopback),
]
"""IP address of this machine itself."""
Network = Annotated[Annotated[IPv4Network, FROM_TEXT] | Annotated[IPv6Network, FROM_TEXT], TEXT_ONLY]
"""IP network."""
Networks = Annotated[tuple[Network, ...], FROM_TEXT]
"""IP networks."""
