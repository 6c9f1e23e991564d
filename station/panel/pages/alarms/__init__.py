"""The page Alarms: what is wrong, why, and what to do."""
