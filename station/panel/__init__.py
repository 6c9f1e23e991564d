"""The operator's window; the only room that knows Qt."""
