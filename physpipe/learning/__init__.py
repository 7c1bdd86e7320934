"""L4: data for learning, and the one loop that fits every model."""
