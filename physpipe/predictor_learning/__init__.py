"""L5: learning to forecast from tracks, and forecasting."""
