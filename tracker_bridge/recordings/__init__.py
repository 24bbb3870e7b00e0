"""Recordings of tracking systems, in the systems' own files."""
