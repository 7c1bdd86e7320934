"""L4: the one loop that fits every model."""
