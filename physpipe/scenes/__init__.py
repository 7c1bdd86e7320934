"""L2: simulated worlds: terrain, physics, drawing, camera."""
