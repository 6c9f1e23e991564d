"""Values of ERROR_CODE for errors of the handshake, independent of the part."""

ERROR_DEADLINE = 0x2101
"""No result came within the deadline."""
ERROR_ABORTED = 0x2102
"""The PLC aborted the part."""
ERROR_BAD_TRIGGER_ID = 0x2103
"""TRIGGER_ID was 0 or the same as for the previous part."""
ERROR_STUCK_BIT = 0x2104
"""TRIGGER or RESULT_ACK was held too long."""
ERROR_LINK_LOST = 0x2105
"""The link was lost while a result was written."""
