"""From a drawn part to its surfaces: border lines, relief, meshes and materials."""
