"""CorrFlow: dense optical flow by a small network with correlation layers, coarse to fine."""
