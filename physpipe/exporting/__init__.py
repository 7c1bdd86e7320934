"""L6: tracks and films for people and for other programs."""
