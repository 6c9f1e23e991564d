"""Offline bundle of the line PC: packages with their hashes, and the scripts that install and remove them."""
