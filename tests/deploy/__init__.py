"""Tests of demo, documentation and packaging."""
