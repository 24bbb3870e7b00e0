"""`swarm` and `python -m swarm`: it obeys signals before it loads what it works with."""

from swarm.signals import obeying_signals


def main() -> None:
    """Entry point of `swarm`."""
    with obeying_signals():
        from swarm.cli.main import main as swarm

        swarm()


if __name__ == "__main__":
    main()
