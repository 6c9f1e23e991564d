"""The archive: a folder of records and their index; nothing in it is ever changed, only the oldest is let go."""
