"""The shared library of the swarm runtime: messages, bus, clocks, learning, analysis."""
