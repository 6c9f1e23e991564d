"""From surfaces to camera images: optics, light, rays and sensor."""
