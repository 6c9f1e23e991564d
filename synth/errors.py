"""SynthError: a user's mistake in a generator command, said in one line."""


class SynthError(Exception):
    """What is wrong, where, and what to do."""
