"""L1: every file format of the pipeline; nothing else reads or writes files."""
