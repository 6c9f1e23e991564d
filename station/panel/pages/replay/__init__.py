"""The page Replay: recorded images judged again."""
