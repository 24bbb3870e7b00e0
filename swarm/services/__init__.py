"""How a process lives under systemd, or under this package's supervisor where there is no systemd."""
