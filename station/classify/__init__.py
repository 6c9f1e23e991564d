"""From strip to scores to verdict."""
