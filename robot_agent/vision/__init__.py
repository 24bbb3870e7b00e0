"""From a camera's frame to where the demonstrator stands."""
