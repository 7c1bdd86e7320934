"""Tracker and predictor, each learned alone, learn from each other."""
