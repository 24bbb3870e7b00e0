"""What decides in a robot."""
