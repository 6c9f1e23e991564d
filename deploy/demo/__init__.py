"""The demo: runs the station with an emulated camera, rendered parts and a simulated line."""
