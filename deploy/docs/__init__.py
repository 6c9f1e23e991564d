"""The pages for readers, and what builds them into a site that can be read without a network."""
