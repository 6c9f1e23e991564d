"""The PLC side: bits, registers, edges."""
