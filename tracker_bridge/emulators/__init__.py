"""Tracking systems played by this project, so that a laboratory can rehearse."""
