"""What joins the rooms: demo, benchmark, example settings."""
