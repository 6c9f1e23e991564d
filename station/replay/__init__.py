"""Judges recorded images again with the line's own code: on all cores, resumable, compared with records."""
