"""Recorded images judged again with the line's own code: on all cores, resumable, compared with what the line said."""
