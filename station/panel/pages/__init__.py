"""Pages of the window, one folder for each."""
