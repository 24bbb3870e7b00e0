"""The swarm server: recorder, conductor, simulation, health."""
