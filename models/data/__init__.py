"""Images to learn from and to judge: lots and datasets, read as labelled crops, and their variation."""
