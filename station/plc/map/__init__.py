"""The register map and its codes, and the documents printed from them."""
