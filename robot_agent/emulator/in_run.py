"""The emulated robots of a run: each in its compartment, where the simulated tracker is shown it."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from contextlib import ExitStack
from functools import partial

from robot_agent.addresses import add_address_argument, addresses
from robot_agent.drivers.epuck_driver import now_at
from robot_agent.drivers.sim.body import BodyFaults
from robot_agent.emulator.emulation import Emulation, RobotToEmulate
from robot_agent.emulator.faults import Faults
from swarm.config.experiment import Experiment
from swarm.geometry import Pose
from swarm.learning.random import spawned_generator
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.identity import RunIdentity
from swarm.runtime.node import Node
from swarm.runtime.process import OneLineParser, add_common_arguments, joined, load_experiment
from swarm.runtime.subscription import Subscription
from swarm.signals import leave_on_signals


def emulate_robots(arguments: argparse.Namespace) -> None:
    """Serve the robots at their addresses until the run ends."""
    experiment = load_experiment(arguments)
    leave_on_signals()
    places = addresses(arguments.address)
    faults = Faults.parse(arguments.fault)
    identity = RunIdentity.of(experiment, arguments.trial)
    with (
        joined(arguments, "emulator", ["robots"], experiment.simulation.tick_s, identity) as node,
        ExitStack() as served,
    ):
        robots = [
            EmulatedInRun(
                served.enter_context(emulation_of(experiment, robot, address, faults, arguments)), node, robot
            )
            for robot, address in places.items()
        ]
        truths: dict[str, Pose] = {}
        for robot in robots:
            robot.see(experiment, truths, arguments.trial)
        node.run(partial(_step, robots, node.subscribe(topics.TRUTH), truths))


def emulation_of(
    experiment: Experiment, name: str, address: str, faults: Faults, arguments: argparse.Namespace
) -> Emulation:
    """The robot at the start of its compartment, with the experiment's slips and lateness."""
    robot, body = experiment.robot_named(name), experiment.body
    walls = experiment.compartment(robot)
    wanted = RobotToEmulate(
        robot.driver,
        walls,
        Pose(*walls.centre(walls.grid.start), 0.0),
        body=BodyFaults(body.slip_sd, body.gain_error_sd, body.latency_s),
        faults=faults,
    )
    rng = spawned_generator(experiment.run.seed, robot.group, arguments.trial, name, "body")
    return Emulation(wanted, address, now_at(arguments.speed), rng)


class EmulatedInRun:
    """One emulated robot that publishes its truth at every tick and can be carried, as a simulated one."""

    def __init__(self, emulation: Emulation, node: Node, name: str) -> None:
        self._emulation = emulation
        self._node = node
        self._name = name
        self._carries = node.subscribe(topics.CARRY, name)

    def see(self, experiment: Experiment, truths: Mapping[str, Pose], trial: int) -> None:
        """Give a robot that watches another something to see; rendering is loaded for nobody else."""
        settings, robot = experiment.robot_named(self._name), self._emulation.robot
        if not settings.watches:
            return
        from robot_agent.emulator.camera import rendered_look

        rng = experiment.generator(settings, trial, "camera")
        robot.look = rendered_look(experiment, settings, robot.truth, truths, rng)

    def step(self) -> None:
        emulation = self._emulation
        with emulation.lock:
            truth = emulation.robot.truth(emulation.now_ns())
            for carry in self._carries.take():
                to = carry.message
                emulation.robot.place(Pose(to.x_m, to.y_m, to.theta_rad))
            contacts = emulation.robot.wall_contacts
        message = pb.Truth(x_m=truth.x_m, y_m=truth.y_m, theta_rad=truth.theta_rad, wall_contacts=contacts)
        self._node.publish(topics.TRUTH, message, self._name)


def _step(
    robots: list[EmulatedInRun],
    told: Subscription[pb.Truth],
    truths: dict[str, Pose],
    t_ns: int,  # noqa: ARG001
) -> None:
    for received in told.take():
        truth = received.message
        truths[received.robot] = Pose(truth.x_m, truth.y_m, truth.theta_rad)
    for robot in robots:
        robot.step()


def emulate_robots_parser() -> OneLineParser:
    parser = OneLineParser(
        prog="robot-agent emulate-robots",
        description="The emulated robots of a simulated run; the server starts it for `--emulate`.",
    )
    add_common_arguments(parser)
    add_address_argument(parser)
    parser.add_argument("--fault", action="append", default=[], metavar="NAME=VALUE", help="see `emulate`")
    return parser
