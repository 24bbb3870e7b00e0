"""Tests of swarm.services."""
