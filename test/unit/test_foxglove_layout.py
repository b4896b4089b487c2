"""The layout for Foxglove: its panels, and the topics and services that it names."""

import json
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LAYOUT = json.loads((ROOT / "config" / "foxglove.json").read_text())
PANELS = LAYOUT["configById"]
PAGE = (ROOT / "doc" / "foxglove.md").read_text()


def panels_in(tree):
    """Return the panels of a part of the layout."""
    return [tree] if isinstance(tree, str) else [*panels_in(tree["first"]), *panels_in(tree["second"])]


def topics():
    """Return the topics of all panels."""
    names = list(PANELS["3D!map"]["topics"])
    names += [one.get("topicToRender") or one.get("topicPath", "").split(".")[0] for one in PANELS.values()]
    names += [path["value"].split(".")[0] for path in PANELS["StateTransitions!mode"]["paths"]]
    return sorted(set(filter(None, names)))


def test_foxglove_layout_has_documented_topics_in_panels():
    assert sorted(panels_in(LAYOUT["layout"])) == sorted(PANELS)
    assert [one for one in topics() if f"`{one}`" not in PAGE and f"`{one[1:]}`" not in PAGE] == []


def test_foxglove_layout_commands_are_services_of_the_core():
    reference = (ROOT / "doc" / "reference.md").read_text()
    calls = [one for name, one in PANELS.items() if name.startswith("CallService!")]
    assert {one["serviceName"] for one in calls} == {"/rosoclingo/pause", "/rosoclingo/stop"}
    assert "- `~pause` (std_srvs/SetBool)" in reference
    assert "- `~stop` (std_srvs/Trigger)" in reference
    assert [json.loads(one["requestPayload"]) for one in calls] == [{"data": True}, {"data": False}, {}]
