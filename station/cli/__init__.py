"""Commands of the line PC."""
