"""What `tracker-bridge VERB` does: a file a verb, with `add_arguments` and `run`."""

VERBS = {
    "check": "Listen for some seconds: what arrives, from whom, how often, who is missing, what is wrong.",
    "watch": "Show the robots' poses as they arrive, until Ctrl-C.",
    "calibrate": "Find the axes, the unit, the origin and the turn from robots at known places.",
    "calibrate camera": "Find a camera's lens from a board, and its place from tags on the floor.",
    "emulate": "Play a tracking system: serve a swarm in the system's own bytes.",
    "emulate camera": "Render the pictures of a camera above a swarm with tags.",
    "decode": "Print what is in a captured packet.",
    "detect": "Find printed tags in a picture.",
    "hats": "Design hats of markers, check the hats in use, or draw a sheet to build them from.",
}
"""A new verb adds one line here and a file of its name beside."""
