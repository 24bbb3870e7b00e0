"""Cameras of real robots: on the link, on the board, and stored pictures in their place."""
