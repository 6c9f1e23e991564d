"""Names of the export formats."""

FORMATS = ("csv", "json", "parquet", "dataset", "reviewed", "dfq")
"""Three tables; crops by the station's decisions, or by the reviews of two people; Q-DAS ASCII."""
