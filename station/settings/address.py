"""Addresses in the settings: always a text, never one of the numbers that it stands for."""

from ipaddress import IPv4Network, IPv6Network
from typing import Annotated

from pydantic import Field

from station.numbers import LAST_PORT
from station.settings.section import FROM_TEXT, TEXT_ONLY

Port = Annotated[int, Field(ge=1, le=LAST_PORT)]
"""TCP port."""
Network = Annotated[Annotated[IPv4Network, FROM_TEXT] | Annotated[IPv6Network, FROM_TEXT], TEXT_ONLY]
"""IP network."""
Networks = Annotated[tuple[Network, ...], FROM_TEXT]
"""IP networks."""
