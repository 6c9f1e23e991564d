"""From frame to strip: find the ring, judge the picture, unwrap it. Pure functions."""
