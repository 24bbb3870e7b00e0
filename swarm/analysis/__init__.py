"""Logs and results to tables, statistics, figures and reports."""
