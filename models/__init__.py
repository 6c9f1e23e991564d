"""Learns from recorded or rendered parts; ships one file."""
