"""Copying by camera: seeing, watching, segments, moves."""
