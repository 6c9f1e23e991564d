"""From frame to verdict: one inspector for line, replay and self-test."""
