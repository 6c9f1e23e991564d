"""Images to learn from and to judge: labelled crops in memory, read from lots and datasets, and varied for training."""
