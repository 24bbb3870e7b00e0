"""What `swarm status` shows of a run."""

from __future__ import annotations

import io

from rich.console import Console

from swarm.control.status_table import status_table
from swarm.messages import swarm_pb2 as pb

STATUS = pb.RunStatus(
    experiment="small",
    phase=pb.RunState.PAUSED,
    reason="anna@lab (lunch)",
    t_ns=100 * 10**9,
    elapsed_s=3700.0,
    time_left_s=7200.0,
    moves_wanted=500,
    missing=["the tracker bridge"],
    robots=[
        pb.RobotStatus(
            robot="r0", role="learner", condition="given", present=True, activity="deciding", moves=120,
            best_path=9, battery_v=3.2, pose_age_s=0.1, messages_per_s=11.0,
        ),
        pb.RobotStatus(robot="r1", role="expert", condition="expert", pose_age_s=1e5, heard_age_s=1e5),
        pb.RobotStatus(robot="r2", role="learner", present=True, estopped=True, heard_age_s=7.0),
    ],
    prompts=[pb.Prompt(number=3, robot="r0", text="please carry r0 home")],
    events=[pb.RecentEvent(t_ns=90 * 10**9, sender="r0", level=pb.Event.INFO, name="paused", text="stands")],
)  # fmt: skip


def shown(status: pb.RunStatus) -> str:
    text = io.StringIO()
    Console(file=text, width=120).print(status_table(status))
    return text.getvalue()


def test_a_screen_tells_state_robots_prompts_and_news() -> None:
    text = shown(STATUS)
    assert "small trial 0: paused, anna@lab (lunch); 62 min so far, about 2.0 h left" in text
    assert "waiting for the tracker bridge" in text
    assert "prompt 3: please carry r0 home (swarm done 3)" in text
    assert "10 s ago  r0 paused: stands" in text
    r0, r1, r2 = (next(line for line in text.splitlines() if line.startswith(f" r{n}")) for n in range(3))
    assert r0.split() == ["r0", "given", "deciding", "120/500", "9", "3.20", "V", "0.1", "s", "old", "11/s"]
    assert r1.split()[-2:] == ["never", "gone"]
    assert "estopped" in r2
    assert "silent 7.0 s old" in r2
