"""Colours, fonts and translations of the window."""
