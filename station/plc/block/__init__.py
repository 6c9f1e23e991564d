"""The PLC's side of the handshake: one definition, printed for each PLC and run by the simulated line."""
