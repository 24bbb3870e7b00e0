"""The process beside the tracking system: it tells each robot its own pose."""
