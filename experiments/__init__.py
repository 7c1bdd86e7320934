"""Many variants of the pipeline, run through DVC's queue; stands above the stages and imports no part of them."""
