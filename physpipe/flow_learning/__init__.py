"""L5: learning optical flow from drawn pairs."""
