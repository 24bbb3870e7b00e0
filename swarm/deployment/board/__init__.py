"""What `swarm deploy` does on a machine: this package is sent there, and needs nothing but its Python.

    python3 board.pyz < REQUEST

Request and answer are JSON: no shell on the way finds anything in it. The answer is a line `step` for what is
begun, and at last `result` or `error`. In the machine's directory are

    wheels/DIGEST/NAME      what was copied
    programs/ID             a virtual environment made of wheels
    releases/ID             a program, the units of its services, an experiment: everything that runs
    current, before         the releases that run, and that ran before
    services, log           of a machine without systemd
    state, runs             what agents have learnt; what the server has recorded
"""
