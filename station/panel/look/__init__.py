"""Colours, fonts and words of the window."""
