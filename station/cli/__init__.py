"""Commands of `weldgate`."""
