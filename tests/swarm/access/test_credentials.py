"""What a process that was given the wrong folder says."""

from __future__ import annotations

from pathlib import Path

import pytest

from swarm.access.credentials import zenoh_values
from swarm.errors import UserError
from tests.support.certified import CertifiedLaboratory


def test_a_folder_that_is_nobodys_is_told_of(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="is not there; `swarm lab keys` makes them"):
        zenoh_values(tmp_path, hub=False)


def test_a_server_with_a_robots_folder_is_told_of(tmp_path: Path) -> None:
    laboratory = CertifiedLaboratory(tmp_path)
    with pytest.raises(UserError, match="is not there; the server's are needed here"):
        zenoh_values(laboratory.keys("robot-r0"), hub=True)
