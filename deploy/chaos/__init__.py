"""Stress tests: faulty PLCs, killed processes, hanging windows."""
