"""A run to look at: one history of what was said, shown in a browser or in a terminal, live or finished."""
