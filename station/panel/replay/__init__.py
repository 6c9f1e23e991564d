"""Recorded images judged again."""
