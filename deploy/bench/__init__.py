"""Benchmarks; each is a command that prints its times as a table."""
