"""Unsupervised intuitive physics: raw video to tracks to forecasts."""
