"""L6: the commands of `physpipe`, a module each: its words, and which library function they call."""
