"""The tools of `robot-agent`, a file each."""
