"""One part as data: recipes and what is drawn from them."""
