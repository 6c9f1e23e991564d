"""The page History: search, filmstrip, one record in full, review, exports."""
