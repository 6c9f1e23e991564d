"""Benchmarks, each a command: what it takes, in one table."""
