"""Tracking systems played by this project, in their own bytes, so that a laboratory can rehearse."""
