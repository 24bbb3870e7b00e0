"""The live link between two processes' sessions: numbered, addressed, and on time."""

from __future__ import annotations

from itertools import count

from swarm.clock import unix_clock
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.liveliness import Presence, claim
from swarm.runtime.node import LiveNode, Sequencer
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint

PERIOD_S = 0.01


def test_each_key_is_numbered_from_one() -> None:
    sequencer = Sequencer()
    assert [sequencer.following(key) for key in ("a", "b", "a", "a", "b")] == [1, 1, 2, 3, 2]


def test_a_robot_hears_its_own_messages_numbered_without_gaps() -> None:
    endpoint = free_endpoint()
    with (
        Session(SessionSettings(endpoint, hub=True)) as here,
        Session(SessionSettings(endpoint)) as there,
    ):
        claim(here, Presence("server", "server", "here", 77))
        publisher = LiveNode(here, unix_clock(), PERIOD_S, epoch=77)
        receiver = LiveNode(there, unix_clock(), PERIOD_S, epoch=78)
        own, everyone = receiver.subscribe(topics.ORDER, "a"), receiver.subscribe(topics.ORDER)
        orders, all_orders = [], []
        numbering = count()

        def step(t_ns: int) -> None:  # noqa: ARG001
            number = next(numbering)
            for robot in ("a", "b"):
                publisher.publish(topics.ORDER, pb.Order(kind=pb.Order.RUN, reason=str(number)), robot)
            orders.extend(own.take())
            all_orders.extend(everyone.take())
            if len(orders) >= 20:
                publisher.publish(topics.RUN_STATE, pb.RunState(phase=pb.RunState.ENDED))

        receiver.run(step)
    assert {order.robot for order in orders} == {"a"}
    assert {order.robot for order in all_orders} == {"a", "b"}
    numbers = [order.header.sequence for order in orders]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    assert {order.header.epoch for order in orders} == {77}
    assert all(order.message.reason == str(order.header.sequence - 1) for order in orders)


def test_ticks_are_multiples_of_the_period() -> None:
    ticks: list[int] = []
    with Session(SessionSettings(free_endpoint(), hub=True)) as session:
        claim(session, Presence("server", "server", "here", 1))
        node = LiveNode(session, unix_clock(), PERIOD_S, epoch=1)

        def step(t_ns: int) -> None:
            ticks.append(t_ns)
            if len(ticks) >= 5:
                node.publish(topics.RUN_STATE, pb.RunState(phase=pb.RunState.ENDED))

        node.run(step)
    assert all(t_ns % 10_000_000 == 0 for t_ns in ticks)
    assert sorted(set(ticks)) == ticks
