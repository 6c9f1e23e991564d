"""Frame to verdict: one inspector for line, replay and self-test."""
