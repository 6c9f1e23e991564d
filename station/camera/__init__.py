"""Cameras of all makes, behind one interface."""
