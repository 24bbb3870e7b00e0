"""Tracking systems, real and simulated."""
