"""L5: learning the tracker, without labels."""
