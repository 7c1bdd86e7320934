"""L3: tables of tracks and forecasts against the truth; gives the figures that the report shows."""
