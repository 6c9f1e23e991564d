"""Names of the forms that records are exported in."""

FORMATS = ("csv", "json", "parquet", "dataset", "reviewed", "dfq")
"""Tables; crops by what was judged, or by what two people agree on; Q-DAS ASCII."""
