"""The classifier of the published paper, trained as described there: the yardstick for time and accuracy."""
