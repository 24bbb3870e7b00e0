"""The layouts in deploy/viewers name nothing that a log does not have."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from tests.conftest import SmallRun
from tests.support.swarm_runs import ROOT

VIEWERS = ROOT / "deploy" / "viewers"
Field = tuple[str, str]
"""A topic, and a field of its messages; empty for all of it."""


@pytest.fixture(scope="module")
def fields(small_run: SmallRun) -> set[Field]:
    """What a small real log has, as a reader that this project did not write decodes it."""
    found: set[Field] = set()
    with small_run.log.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, channel, _, message in reader.iter_decoded_messages():
            found.add((channel.topic, ""))
            found |= {(channel.topic, field.name) for field in message.DESCRIPTOR.fields}
    return found


def foxglove_fields(panels: dict[str, Any]) -> Iterator[Field]:
    """Topics and message paths of every panel."""
    for panel in panels.values():
        for topic in [*panel.get("topics", {}), *filter(None, [panel.get("topicToRender")])]:
            yield topic, ""
        for path in panel.get("paths", []):
            topic, _, field = path["value"].partition(".")
            yield topic, field


def plotjuggler_fields(path: Path) -> Iterator[Field]:
    """PlotJuggler joins topic and field with a slash."""
    for curve in ElementTree.parse(path).iter("curve"):
        names = [curve.get("curve_x"), curve.get("curve_y")] if curve.get("curve_x") else [curve.get("name")]
        for name in filter(None, names):
            topic, _, field = name.rpartition("/")
            yield topic, field


def panels_in(layout: Any) -> list[str]:
    """The panels of a layout's tree."""
    return [layout] if isinstance(layout, str) else panels_in(layout["first"]) + panels_in(layout["second"])


def test_every_topic_and_field_of_the_foxglove_layout_is_in_a_log(fields: set[Field]) -> None:
    layout = json.loads((VIEWERS / "foxglove.json").read_text(encoding="utf-8"))
    named = set(foxglove_fields(layout["configById"]))
    assert len(named) > 10
    assert named - fields == set()
    assert sorted(panels_in(layout["layout"])) == sorted(layout["configById"])


def test_every_curve_of_the_plotjuggler_layout_is_in_a_log(fields: set[Field]) -> None:
    named = set(plotjuggler_fields(VIEWERS / "plotjuggler.xml"))
    assert len(named) > 10
    assert named - fields == set()
