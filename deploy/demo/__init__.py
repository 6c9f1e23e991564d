"""The demo: emulated camera, rendered parts, simulated line and the station, with one command."""
