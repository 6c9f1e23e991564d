"""LearningError: a user's mistake in a learning command, said in one line."""


class LearningError(Exception):
    """What is wrong, where, and what to do."""
