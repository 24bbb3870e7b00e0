"""The simulated figures of the paper: one file each, with what its text says of it."""
