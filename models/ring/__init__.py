"""The ring network, which finds the weld's centre line: its training, its file and pairs of two."""
