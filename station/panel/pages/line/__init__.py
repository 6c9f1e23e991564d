"""The page Line: bits, registers and edges between station and PLC."""
