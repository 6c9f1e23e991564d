"""What the window knows of the engine and of who is logged in, and how it asks."""
