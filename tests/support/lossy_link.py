"""A link between two network namespaces that loses packets: what a kernel without netem lacks.

`python -m tests.support.lossy_link NEAR NEAR_ADDRESS FAR FAR_ADDRESS SEED` joins a TUN device in each (an
empty name is this machine's own namespace) and carries packets between them. A number on standard input is
the share of packets that is lost from then on, in both directions; the process ends with its input.
"""

from __future__ import annotations

import ctypes
import fcntl
import os
import random
import select
import struct
import subprocess
import sys

CLONE_NEWNET = 0x40000000
"""From linux/sched.h."""
TUNSETIFF = 0x400454CA
IFF_TUN_NO_PI = 0x1001
"""Both from linux/if_tun.h: packets as they are, without a header before them."""
LARGEST_PACKET = 65_536


def main(near: str, near_address: str, far: str, far_address: str, seed: str) -> None:
    """Carry packets until standard input ends."""
    libc, rng, loss = ctypes.CDLL(None, use_errno=True), random.Random(int(seed)), 0.0
    own = os.open("/proc/self/ns/net", os.O_RDONLY)
    ends = []
    for name, address in ((near, near_address), (far, far_address)):
        place = os.open(f"/run/netns/{name}", os.O_RDONLY) if name else own
        if libc.setns(place, CLONE_NEWNET):
            raise OSError(ctypes.get_errno(), f"cannot enter {name}")
        ends.append(device(f"lossy{address.split('.')[2]}", address))
    print("ready", flush=True)
    other = {ends[0]: ends[1], ends[1]: ends[0]}
    while True:
        ready, _, _ = select.select([*ends, sys.stdin.fileno()], [], [])
        if sys.stdin.fileno() in ready:
            line = sys.stdin.readline()
            if not line:
                return
            loss = float(line)
        for end in set(ready) & set(ends):
            packet = os.read(end, LARGEST_PACKET)
            if rng.random() >= loss:
                os.write(other[end], packet)


def device(name: str, address: str) -> int:
    """A TUN device in the namespace that this process is in."""
    tun = os.open("/dev/net/tun", os.O_RDWR)
    fcntl.ioctl(tun, TUNSETIFF, struct.pack("16sH22x", name.encode(), IFF_TUN_NO_PI))
    for words in (("address", "add", f"{address}/24", "dev", name), ("link", "set", name, "up")):
        subprocess.run(["ip", *words], check=True)
    return tun


if __name__ == "__main__":
    main(*sys.argv[1:])
