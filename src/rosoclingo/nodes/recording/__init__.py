"""A run as a bag, whole whatever happens."""
