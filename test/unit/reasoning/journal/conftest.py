"""What tests of the journal share."""

import pytest
from kept_node import Node


@pytest.fixture
def start(tmp_path):
    """Start a core on the journal of the one before, which ends without a word."""
    nodes = []

    def make(*options, **more):
        for node in nodes:
            node.folder.close()
        nodes.append(Node(tmp_path, *options, **more))
        return nodes[-1]

    yield make
    nodes[-1].folder.close()
