"""L3: trackers that learn nothing from the film: what ours is compared with, and the one behind truth."""
