"""Judged claims as JSON, Markdown and HTML."""
