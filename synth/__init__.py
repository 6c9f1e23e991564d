"""Parts that never existed: rendered frames of circular laser welds with exact labels."""
