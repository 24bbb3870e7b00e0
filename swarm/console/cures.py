"""What a person can do about an event, by the event's name."""

CURES = {
    "back": "Nothing: it goes on from its checkpoint.",
    "camera": "Unplug the camera and plug it in again.",
    "carry": "Carry the robot to the place that is named, then confirm.",
    "checkpoint": "Free some space on the robot's card, or what it learns is lost when it restarts.",
    "clock": "Let that machine follow a time server (NTP).",
    "displaced": "Nothing, if somebody carried it; else look for a body that the tracker confuses with it.",
    "gone": "Look at its battery and its link, and start its process again: it goes on from its checkpoint.",
    "interrupted": "Go on with: swarm-server --resume RUN.",
    "link": "Look at the cable or the radio; the watchdog holds the wheels meanwhile.",
    "lost": "Look whether the tracking system sees its markers; the robot stands until it is seen.",
    "refused": "A single one is noise; many: look at the markers, or for a process of another run.",
    "robot": "Look at the robot itself: its battery, its selector, its wheels.",
    "stands": "Set it on a cell of its compartment, and look at its wheels and its poses.",
    "watchdog": "If it happens again, look at the board's memory and load.",
}
"""Names as the server, the tracker bridge and the agents say them."""
