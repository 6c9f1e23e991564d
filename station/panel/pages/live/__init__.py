"""What the operator looks at: frame, strip, lamp, clock face."""
