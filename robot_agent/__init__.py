"""The process on each robot: observe, decide, act, learn, report."""
