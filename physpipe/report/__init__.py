"""L5: metrics files, figures, overlays and the page."""
