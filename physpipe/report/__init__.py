"""L6: metrics files, figures, overlays and the page."""
