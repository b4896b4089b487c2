"""Arrays for messages of rospy.numpy_msg, whatever the version of numpy."""

import numpy as np

__all__ = ["sendable"]


class _Sendable(np.ndarray):
    """An array with the method that ROS's generated messages call: numpy has done away with it in 2.3."""

    def tostring(self, order: str = "C") -> bytes:  # type: ignore[override]
        """Return the array's bytes."""
        return self.tobytes(order)  # type: ignore[arg-type]


def sendable(array: np.ndarray) -> np.ndarray:
    """Return an array, which shares its memory, that a message of rospy.numpy_msg can hold."""
    return array.view(_Sendable)
