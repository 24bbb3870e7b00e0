"""A renderer of its own, to judge the camera pipeline with: another model of light, lens and sensor.

What a pipeline was tuned on cannot judge it, so nothing here shares code or constants with the
robot's own simulated camera. A scene is ray-traced in linear light; the optics blur, distort and
darken it; the sensor turns it into the bytes that a driver would hand on.
"""
