"""L3: trackers on one contract."""
