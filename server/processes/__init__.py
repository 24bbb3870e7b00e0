"""The processes of a simulated trial, started, watched and ended."""
