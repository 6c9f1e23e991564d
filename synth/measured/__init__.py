"""Surface measurements of a real weld, and the weld model derived from them."""
