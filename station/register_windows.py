"""Start and size of the two windows of the register map.

Settings check the addresses in the PLC against these numbers; a test ensures that the register map fills the
windows.
"""

COMMAND_START = 0
"""First register of the command window, which the PLC writes and the station reads."""
COMMAND_WORDS = 23
"""Number of registers in the command window."""
STATUS_START = 100
"""First register of the status window, which the station writes and the PLC reads."""
STATUS_WORDS = 76
"""Number of registers in the status window."""
