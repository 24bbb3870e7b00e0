"""`swarm-server` and `python -m server`: it obeys signals before it loads what it works with."""

from swarm.signals import obeying_signals


def main() -> None:
    """Entry point of `swarm-server`."""
    with obeying_signals():
        from server.main import main as swarm_server

        swarm_server()


if __name__ == "__main__":
    main()
