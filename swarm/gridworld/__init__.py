"""The grid worlds of section 2 and their compiled engine."""
