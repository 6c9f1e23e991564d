"""Files on disk: atomic writes, images, SQLite databases, locks and the installation's folders."""
