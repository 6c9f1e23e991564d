"""A PLC in software: runs the block against a station, with failures on demand; not part of the engine."""
