"""L3: the contract of every tracker, and the learned one."""
