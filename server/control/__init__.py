"""What a person at the controls wants of a live run, and what they see of it."""
