"""Bodies and cameras of robots, real and simulated."""
