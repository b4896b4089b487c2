"""Fixtures that the journal tests share."""

import pytest
from kept_node import Node


@pytest.fixture
def start(tmp_path):
    """Start a core on the journal that a killed core left behind."""
    nodes = []

    def make(*options, **more):
        for node in nodes:
            node.folder.close()
        nodes.append(Node(tmp_path, *options, **more))
        return nodes[-1]

    yield make
    nodes[-1].folder.close()
