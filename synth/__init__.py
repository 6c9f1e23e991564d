"""The generator: rendered frames of circular laser welds with exact labels."""
