"""What the commands write: datasets, lots, contact sheets, figures, calibrations."""
