"""L2: recordings, whatever their rate, size and shape, to clips."""
