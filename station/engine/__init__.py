"""The engine: one trigger, one part, one record, one answer to the PLC."""
