"""A camera above the arena, rendered by following each pixel's rays down to the hats.

It shares no code with `tracker_bridge.overhead`, which is judged on its frames.
"""
