"""Demonstrations from wheels to copied moves in one process: a robot drives, another watches and copies.

The parts are those of a run (body, pose estimator, motion, camera, detector, observer, copying); the network,
the conductor and the learning are left out.
"""
