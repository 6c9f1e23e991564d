"""station.toml and what was changed at the station, as checked values."""
