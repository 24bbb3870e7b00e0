"""Experiment files: TOML to typed settings."""
