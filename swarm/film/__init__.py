"""A stretch of one robot's learning as a film: the arena, its camera, its curve."""
