"""The page Statistics: yield, counts and trends."""
