"""L2: the unsupervised tracker's networks and losses (paper section 3.1)."""
