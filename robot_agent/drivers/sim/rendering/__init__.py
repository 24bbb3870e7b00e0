"""The simulated camera: scene, lens, sensor."""
