"""Robots without wheels: the robots' learning on measured durations and stored copies."""
