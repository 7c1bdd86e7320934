"""`physpipe annotate`: a page on this machine alone, on which a person checks and corrects the truth of filmed sets."""
