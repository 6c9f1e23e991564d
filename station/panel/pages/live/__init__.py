"""The page Live: image, strip, verdict lamp, clock face."""
