"""From frame to strip: find the ring, measure image quality, unwrap the weld. Pure functions."""
