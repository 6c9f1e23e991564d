"""What many records say together: statistics, what-if, exports, reports."""
