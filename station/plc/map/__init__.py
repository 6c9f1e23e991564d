"""Register map, codes, and the documents printed from them."""
