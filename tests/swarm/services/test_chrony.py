"""What chrony says of a clock, from what a chronyd (4.3) on a server's heels has said."""

from __future__ import annotations

from swarm.services.chrony import in_words

FOLLOWING = (
    "0A4F0001,10.79.0.1,9,1795671927.936676595,-0.000002665,-0.000001221,0.000001221,0.029,0.000,16.476,"
    "0.000007657,0.000118701,2.0,Normal\n"
)
ALONE = (
    "00000000,,0,0.000000000,0.000000000,0.000000000,0.000000000,0.0,0.0,0.0,1.0,1.0,0.0,Not synchronised\n"
)


def test_a_clock_that_follows_the_server() -> None:
    """`chronyc tracking` said of the same moment: 0.000002666 seconds fast of NTP time."""
    assert in_words(FOLLOWING) == "0.003 ms fast of 10.79.0.1, to 0.1 ms"
    assert in_words(FOLLOWING.replace("-0.000002665", "0.012")) == "12.000 ms slow of 10.79.0.1, to 0.1 ms"


def test_a_clock_that_follows_nobody() -> None:
    assert in_words(ALONE) == ""
    assert in_words("506 Cannot talk to daemon\n") == ""
