"""Proofs against misbehaving neighbours: PLCs, kills, windows that hang."""
