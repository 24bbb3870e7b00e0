"""Tracking systems that are not there: a laboratory rehearses with them."""
