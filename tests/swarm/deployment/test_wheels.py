"""Which wheels a machine needs: by what it is, and by what its system has already."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from swarm.deployment.wheels import Platform, Wheelhouse, requirements
from swarm.errors import UserError

METADATA = """Metadata-Version: 2.1
Name: swarm-runtime
Version: 3.0
Requires-Dist: eclipse-zenoh<2,>=1.10.2
Requires-Dist: numpy<3,>=2.2
Requires-Dist: opencv-python-headless>=4.10; extra == "vision"
Requires-Dist: spidev<4,>=3.6; extra == "spi"
Requires-Dist: swarm-runtime[vision]; extra == "lab"
Requires-Dist: small-mcap[zstd]>=0.16; extra == "lab"
"""


def wheel_in(directory: Path) -> Path:
    wheel = directory / "swarm_runtime-3.0-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr("swarm_runtime-3.0.dist-info/METADATA", METADATA)
    return wheel


def test_a_machine_with_nothing_gets_everything(tmp_path: Path) -> None:
    needed = ["eclipse-zenoh<2,>=1.10.2", "numpy<3,>=2.2"]
    assert requirements(wheel_in(tmp_path), [], {}) == (needed, False)
    more = ["opencv-python-headless>=4.10", "small-mcap[zstd]>=0.16"]
    assert requirements(wheel_in(tmp_path), ["lab"], {})[0] == [*needed, *more], "an extra may name another"


def test_debian_13_supplies_what_is_new_enough_and_debian_12_does_not(tmp_path: Path) -> None:
    trixie = {"numpy": "2.2.4", "opencv-python-headless": "4.10.0", "spidev": "3.6"}
    assert requirements(wheel_in(tmp_path), ["spi", "vision"], trixie) == (["eclipse-zenoh<2,>=1.10.2"], True)
    bookworm = {"numpy": "1.24.2", "opencv-python-headless": "4.6.0", "spidev": ""}
    needed, uses_system = requirements(wheel_in(tmp_path), ["spi", "vision"], bookworm)
    assert (len(needed), uses_system) == (4, False)


@pytest.mark.parametrize(
    ("machine", "bits", "kind"),
    [
        ("aarch64", 64, "aarch64"),
        ("aarch64", 32, "armv7l"),
        ("armv6l", 32, "armv6l"),
        ("x86_64", 64, "x86_64"),
    ],
)
def test_the_kind_of_machine_is_that_of_its_python(machine: str, bits: int, kind: str) -> None:
    found = {"machine": machine, "bits": bits, "python": "3.13.5", "libc": "2.41"}
    platform = Platform.of(found)
    assert platform.folder == f"cp313-{kind}-glibc2.41"
    assert f"--platform=manylinux_2_28_{kind}" in platform.options
    assert {"--abi=cp313", "--abi=abi3", "--abi=none", "--python-version=3.13"} <= set(platform.options)


def test_a_wheel_in_the_folder_is_taken_and_another_version_is_not_made_up(tmp_path: Path) -> None:
    wheel = wheel_in(tmp_path)
    assert Wheelhouse(tmp_path).program("3.0") == wheel
    with pytest.raises(UserError, match=r"no wheel of swarm-runtime 9\.9, and this is no checkout"):
        Wheelhouse(tmp_path).program("9.9")
