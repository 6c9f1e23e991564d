"""The error that a user's mistake in a generator command raises."""


class SynthError(Exception):
    """A user's mistake: one line with what is wrong, where, and what to do."""
