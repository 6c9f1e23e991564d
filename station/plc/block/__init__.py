"""The PLC's side of the handshake: one definition, in the dialect of each PLC and as Python for the simulated line."""
