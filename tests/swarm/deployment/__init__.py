"""Tests of swarm.deployment."""
