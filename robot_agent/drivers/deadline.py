"""How long a command to a robot's wheels holds."""

from __future__ import annotations

STOP_WITHIN_S = 0.3
"""Without a fresh command the wheels stand after so long: at full speed a robot drives 4 cm meanwhile."""

COMMAND_HOLDS_S = 0.22
"""After so long a watchdog sends the stop. It leaves 0.08 s for the way to the motors (0.06 s over Bluetooth
or Wi-Fi) and for being woken late; an agent that decides ten times a second may miss one tick."""
