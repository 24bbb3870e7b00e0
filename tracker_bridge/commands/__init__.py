"""What `tracker-bridge VERB` does: a file a verb, with `add_arguments` and `run`."""

VERBS = {
    "calibrate": "Find where a tracking system stands: for a camera, its lens and its place over the arena.",
    "detect": "Find printed tags in a picture.",
    "emulate": "Play a tracking system: for a camera, render pictures of a swarm with tags.",
    "hats": "Design hats of markers, check the hats in use, or draw a sheet to build them from.",
}
"""A new verb adds one line here and a file of its name beside."""
