"""Judges recorded images again with the code of the line, and compares them with their records."""
