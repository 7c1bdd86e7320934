"""L3: what can be told of a folder of film before anything is learned from it."""
