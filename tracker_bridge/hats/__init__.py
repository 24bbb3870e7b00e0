"""Robots told apart by the markers on their hats: patterns of pins, and clouds of markers without names."""
