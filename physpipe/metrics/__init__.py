"""L2: errors of tracks and of forecasts; pure functions of arrays."""
