"""Where the robot is, and how it gets to a cell."""
