"""Where a run's messages come together."""
