"""Pages of the window, a room each."""
