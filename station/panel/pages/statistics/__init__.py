"""Yield, counts and trends."""
