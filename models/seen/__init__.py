"""The network that says how much of the weld is hidden in a crop: its covers, its training and its file."""
