"""From crops to scores, findings and verdict: networks, limits, decision and drift."""
