"""Runs the experiment: orders, visits, carrying."""
