"""The simulated robot: body, camera, and what shows the tracker its truth."""
