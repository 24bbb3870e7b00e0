"""How processes of the swarm find each other, talk, and share time."""
