"""What is written into the log."""
