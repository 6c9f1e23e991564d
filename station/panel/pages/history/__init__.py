"""Past parts: filmstrip, search, one record with all that led to its verdict, review."""
