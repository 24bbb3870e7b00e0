"""The controls of a live run, for a person: where it is, how it goes, what it is told."""
