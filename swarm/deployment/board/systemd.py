"""Services of the system's manager."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from swarm.deployment.board.reporting import run

CHRONY_FOLDER = Path("/etc/chrony/conf.d")
"""Where Debian's chrony looks for more settings."""


class Systemd:
    """Services of the system's manager; whoever is not root asks it by sudo."""

    def __init__(self) -> None:
        self._sudo = [] if os.geteuid() == 0 else ["sudo", "-n"]

    def install(self, release: Path) -> None:
        """The units of a release, where systemd looks for them, and from whom the clock is set."""
        units = [str(path) for path in sorted((release / "units").iterdir())]
        run([*self._sudo, "install", "-m", "644", "-t", "/etc/systemd/system", *units])
        self._ask("daemon-reload")
        clock, settings = release / "chrony.conf", CHRONY_FOLDER / "swarm.conf"
        known = settings.read_bytes() if settings.exists() else b""
        if CHRONY_FOLDER.is_dir() and clock.read_bytes() != known:
            run([*self._sudo, "install", "-m", "644", str(clock), str(settings)])
            self._ask("try-restart", "chrony")

    def restart(self, name: str) -> None:
        """Start a service anew, also after the machine's next start; what becomes of it its state tells."""
        self._ask("enable", "--quiet", name)
        self._ask("reset-failed", "--quiet", name)
        words = [*self._sudo, "systemctl", "restart", name]
        subprocess.run(words, capture_output=True, check=False, stdin=subprocess.DEVNULL)

    def stop(self, name: str) -> None:
        """End a service for good."""
        self._ask("disable", "--quiet", "--now", name)

    def state(self, name: str) -> str:
        """active, starting, or what else it is."""
        found = run(["systemctl", "show", "--property=ActiveState,SubState", "--value", name]).split()
        if found == ["activating", "auto-restart"]:
            return "failing"
        return {"activating": "starting", "reloading": "active"}.get(found[0], found[0])

    def last_words(self, name: str) -> str:
        """The last line that a service has printed."""
        asked = [*self._sudo, "journalctl", "--unit", name, "--lines=1", "--output=cat", "--quiet"]
        return subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()

    def _ask(self, *words: str) -> None:
        run([*self._sudo, "systemctl", *words])
