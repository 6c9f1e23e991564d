"""Files on disk: whole or absent, images, SQLite, what other rooms build on."""
