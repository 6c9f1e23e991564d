"""The station of weldgate: inline inspection of circular laser welds."""

__version__ = "0.1.0"
