"""Views of a weld: image with ring, strip, clock face; of the part just inspected and of recorded parts."""
