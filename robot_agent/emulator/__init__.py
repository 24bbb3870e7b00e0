"""Robots that speak the bytes of real ones: firmware on simulated wheels, behind a pty, a socket or a bus."""
