"""Cameras behind one port."""
