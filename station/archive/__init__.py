"""The archive: a folder of records with an index. Records never change; retention deletes the oldest."""
