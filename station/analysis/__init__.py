"""Evaluates many records together: statistics, what-if, exports and reports."""
