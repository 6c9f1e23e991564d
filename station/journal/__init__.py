"""Actions of people and of the station besides inspecting parts: journal, users, reviews."""
