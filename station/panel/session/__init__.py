"""What the window knows of the engine and of its user, and how it sends requests."""
