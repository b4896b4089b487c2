"""Where change_map finds maps."""

from pathlib import Path

import pytest

from rosoclingo.robot.navigation import MapError

pytest.importorskip("rospy")
from rosoclingo.robot.nodes.map_server import local_path  # noqa: E402


def test_map_server_resolves_urls():
    assert local_path("/a/b.yaml") == local_path("file:///a/b.yaml") == Path("/a/b.yaml")
    assert local_path("b.yaml") == Path("b.yaml")
    for url in ("https://example.org/b.yaml", "package://", "package://no_such_package/b.yaml"):
        with pytest.raises(MapError, match=url):
            local_path(url)
