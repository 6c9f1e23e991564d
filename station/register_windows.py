"""The two windows of the register map: where they begin and how many registers they hold.

Settings check the addresses in the PLC by these numbers, and the register map fills the windows: a test fails
if it does not.
"""

COMMAND_START = 0
"""First register of the command window, which the PLC writes and the station reads."""
COMMAND_WORDS = 23
"""Number of registers in the command window."""
STATUS_START = 100
"""First register of the status window, which the station writes and the PLC reads."""
STATUS_WORDS = 76
"""Number of registers in the status window."""
