"""`python -m tracker_bridge`."""

from tracker_bridge.main import main

main()
