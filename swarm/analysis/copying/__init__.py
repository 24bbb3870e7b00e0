"""What became of copied paths."""
