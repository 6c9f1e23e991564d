"""The engine: each trigger gives one part, one record and one result for the PLC."""
