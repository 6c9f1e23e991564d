"""Kinds of defect, one module each."""
