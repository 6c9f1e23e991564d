"""Settings: station.toml and the changes made at the station, validated."""
