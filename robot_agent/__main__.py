"""`python -m robot_agent`."""

from robot_agent.main import main

main()
