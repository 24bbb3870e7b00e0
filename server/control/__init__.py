"""Where people learn how a live run goes, and where their orders come in."""
