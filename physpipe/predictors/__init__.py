"""L2: predictors of motion (paper section 3.2)."""
