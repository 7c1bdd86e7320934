"""L6: whether this machine and this project are fit to run, and what would run."""
