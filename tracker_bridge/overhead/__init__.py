"""Robots with printed tags, seen by cameras above the arena."""
