"""What `tracker-bridge VERB` does: a file a verb, with `add_arguments` and `run`."""

VERBS = {
    "check": "Listen for some seconds: what arrives, from whom, how often, who is missing, what is wrong.",
    "watch": "Show the robots' poses as they arrive, until Ctrl-C.",
    "calibrate": "Find the axes, the unit, the origin and the turn from robots at known places.",
    "emulate": "Play a tracking system: serve a swarm in the system's own bytes.",
    "decode": "Print what is in a captured packet.",
}
"""A new verb adds one line here and a file of its name beside."""
