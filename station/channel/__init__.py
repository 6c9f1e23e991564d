"""Local channel between engine and window: messages and transport."""
