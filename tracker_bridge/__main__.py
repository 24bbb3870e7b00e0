"""`tracker-bridge` and `python -m tracker_bridge`: it obeys signals before it loads what it works with."""

from swarm.signals import obeying_signals


def main() -> None:
    """Entry point of `tracker-bridge`."""
    with obeying_signals():
        from tracker_bridge.main import main as tracker_bridge

        tracker_bridge()


if __name__ == "__main__":
    main()
