"""Generator recipes by name, and recipe files."""
