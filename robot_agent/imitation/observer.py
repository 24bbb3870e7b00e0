"""The observer follows the demonstrator with its camera, looks for it, and notes every frame."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from robot_agent.drivers.interfaces import Camera
from robot_agent.imitation.positions import ObservedPosition, position_from_detection
from robot_agent.navigation.pose_estimator import PoseAt
from robot_agent.vision.detector import Detection, Detector, NotSeen, Reason
from robot_agent.vision.frames import Frame, frame_hash
from swarm.clock import NS_PER_S
from swarm.geometry import Pose, wrap_angle_rad

FOLLOW_GAIN_PER_S = 2.0
"""With the two below it kept every random demonstration in view in a prototype."""
FOLLOW_DEAD_BAND_RAD = 0.07
"""4 degrees, a thirteenth of the field of view: a robot that keeps turning blurs what it sees."""
FASTEST_TURN_RAD_PER_S = 1.2
"""Above the 0.7 rad/s (41 degrees/s) at which a robot 14 cm away can pass at 0.10 m/s."""
MOST_REPEATED_FRAMES = 4
"""Noise makes any two frames of a living camera differ."""
MOST_MISSING_FRAMES = 5
"""A second at five frames a second; chosen: shorter than a move, so that none is missed unnoticed."""
PUSHED_M = 0.03
"""Chosen: thirty times the tracker's noise of 1 mm, and a quarter of a cell."""
VAGUE_M = 0.09
"""Three quarters of a cell: a detection whose range is less sure does not show whether a move was made."""


@dataclass(frozen=True, slots=True)
class ObservedFrame:
    """One frame: its hash, what the detector said of it, and the position that follows."""

    t_ns: int
    frame_hash: int
    answer: Detection | NotSeen
    position: ObservedPosition | None


class Watch:
    """One observation, from its first frame to its last.

    Call `step` at every tick with the own pose; it returns the turning speed that follows the
    demonstrator, or looks for it. `failed` says why the observation had to be given up: nothing is
    learnt from it.
    """

    def __init__(
        self,
        camera: Camera,
        detector: Detector,
        pose_at: PoseAt,
        began_ns: int,
        duration_s: float,
        frames_per_s: float,
    ) -> None:
        self.looks: list[ObservedFrame] = []
        self.failed = ""
        self._camera = camera
        self._detector = detector
        self._pose_at = pose_at
        self._ends_ns = began_ns + round(duration_s * NS_PER_S)
        self._period_ns = round(NS_PER_S / frames_per_s)
        self._due_ns = began_ns
        self._stood: Pose | None = None
        self._search = Search(began_ns)
        self._towards_rad: float | None = None
        self._looked_from_rad: float | None = None
        self._repeated = 0
        self._missing = 0
        self.expected_frames = round(duration_s * frames_per_s)
        detector.reset()

    def ended(self, t_ns: int) -> bool:
        """Whether the time is up or the observation was given up."""
        return bool(self.failed) or t_ns >= self._ends_ns

    def step(self, own_pose: Pose | None, t_ns: int) -> float:
        """Take a frame if one is due; return the turning speed in rad/s, counter-clockwise."""
        if own_pose is None:
            return 0.0
        self._stood = self._stood or own_pose
        if self._stood.distance_m(own_pose) > PUSHED_M:
            self.failed = "the observer was pushed"
        elif self._due_ns <= t_ns < self._ends_ns:
            self._due_ns += self._period_ns
            self._take(self._camera.capture(t_ns))
        return self._turn_rad_per_s(own_pose)

    @property
    def positions(self) -> list[ObservedPosition]:
        """Where the demonstrator was seen, in order of time; half hidden and far away it was not."""
        return [
            observed.position
            for observed in self.looks
            if observed.position and not _is_vague(observed.answer)
        ]

    def commonest_reason(self) -> str:
        """Why the demonstrator was most often not seen; empty if it always was."""
        counts = Counter(
            observed.answer.reason for observed in self.looks if isinstance(observed.answer, NotSeen)
        )
        return counts.most_common(1)[0][0].value if counts else ""

    def _take(self, frame: Frame | None) -> None:
        exposed_from = self._pose_at(frame.t_ns) if frame else None
        if frame is None or exposed_from is None:
            self._missing += 1
            if self._missing > MOST_MISSING_FRAMES:
                self.failed = f"the camera stalled: no frame for {self._missing} periods"
            return
        self._missing = 0
        seen_hash = frame_hash(frame)
        self._repeated = self._repeated + 1 if self.looks and self.looks[-1].frame_hash == seen_hash else 0
        if self._repeated >= MOST_REPEATED_FRAMES:
            self.failed = f"the camera is frozen: {self._repeated + 1} equal frames"
            return
        self._look(frame, seen_hash, exposed_from)

    def _look(self, frame: Frame, seen_hash: int, own_pose: Pose) -> None:
        """A frame comes late: what it shows is put where the robot was when it was exposed."""
        from_rad, self._looked_from_rad = self._looked_from_rad, own_pose.theta_rad
        turned_rad = None if from_rad is None else wrap_angle_rad(own_pose.theta_rad - from_rad)
        answer = self._detector.look(frame, turned_rad)
        self._towards_rad = self._search.towards_rad(answer, own_pose.theta_rad, self._towards_rad)
        position = None
        if isinstance(answer, Detection):
            model = self._detector.model
            bearing_rad = answer.bearing_rad + model.yaw_rad
            self._towards_rad = wrap_angle_rad(own_pose.theta_rad + bearing_rad)
            position = position_from_detection(
                own_pose,
                model.forward_m,
                answer.range_m,
                bearing_rad,
                answer.range_sd_m,
                answer.bearing_sd_rad,
                frame.t_ns,
            )
        self.looks.append(ObservedFrame(frame.t_ns, seen_hash, answer, position))

    def _turn_rad_per_s(self, own_pose: Pose) -> float:
        if self._towards_rad is None or self.failed:
            return 0.0
        error_rad = wrap_angle_rad(self._towards_rad - own_pose.theta_rad)
        if abs(error_rad) < FOLLOW_DEAD_BAND_RAD:
            return 0.0
        wanted = FOLLOW_GAIN_PER_S * error_rad
        return max(-FASTEST_TURN_RAD_PER_S, min(FASTEST_TURN_RAD_PER_S, wanted))


def _is_vague(answer: Detection | NotSeen) -> bool:
    return isinstance(answer, Detection) and answer.cut_off and answer.range_sd_m > VAGUE_M


SEARCH_AFTER_NS = NS_PER_S
"""Chosen: five frames without the demonstrator are more than a glitch, and less than a move."""
SWEEP_RAD = 0.6
"""To either side of the first heading: with half a field of view, more than the corner opens to."""
REACHED_RAD = 0.1
"""Chosen: a little over the dead band, else the robot would stop short of the sweep's end."""
OUT_OF_IMAGE = (Reason.NOT_SEEN, Reason.CUT_OFF, Reason.UNLIKE)
"""Turning helps against these; it does not against darkness, or something that stands before the skirt."""


class Search:
    """Sweeps the compartment once the demonstrator has been out of the image for a second.

    It begins on the side on which the demonstrator was seen last.
    """

    def __init__(self, began_ns: int) -> None:
        self._seen_ns = began_ns
        self._middle_rad: float | None = None
        self._side = 1.0
        self._sweeping = False

    def towards_rad(
        self, answer: Detection | NotSeen, own_theta_rad: float, towards_rad: float | None
    ) -> float | None:
        """The heading to turn to after a frame: as it was, unless the demonstrator has been lost for long."""
        if self._middle_rad is None:
            self._middle_rad = own_theta_rad
        if isinstance(answer, Detection):
            self._seen_ns, self._sweeping = answer.t_ns, False
            return towards_rad
        if answer.reason not in OUT_OF_IMAGE or answer.t_ns - self._seen_ns < SEARCH_AFTER_NS:
            return towards_rad
        if not self._sweeping:
            self._sweeping = True
            aside_rad = wrap_angle_rad(own_theta_rad - self._middle_rad)
            self._side = 1.0 if aside_rad >= 0 else -1.0
        goal_rad = wrap_angle_rad(self._middle_rad + self._side * SWEEP_RAD)
        if abs(wrap_angle_rad(goal_rad - own_theta_rad)) < REACHED_RAD:
            self._side = -self._side
            goal_rad = wrap_angle_rad(self._middle_rad + self._side * SWEEP_RAD)
        return goal_rad
