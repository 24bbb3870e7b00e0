"""`robot-agent` and `python -m robot_agent`: it obeys signals before it loads what it works with."""

from swarm.signals import obeying_signals


def main() -> None:
    """Entry point of `robot-agent`."""
    with obeying_signals():
        from robot_agent.main import main as robot_agent

        robot_agent()


if __name__ == "__main__":
    main()
