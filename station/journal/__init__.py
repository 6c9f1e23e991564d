"""What people and the station did besides inspecting parts: journal, users, reviews."""
