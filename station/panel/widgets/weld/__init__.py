"""Pictures of a weld: ring, strip, angles; of what was just seen and of kept records."""
