"""The compiled loops, compared with brute force."""

from hypothesis import given
from hypothesis import strategies as st
from occupied_grids import GRIDS, clearance_of, distance

from rosoclingo.robot.navigation.compiled.clearance import square_distance


@given(GRIDS, st.floats(1.0, 30.0))
def test_compiled_clearance_is_distance_to_nearest_occupied_square(occupied, reach):
    clearance = clearance_of(occupied, reach)
    for row in range(occupied.shape[0]):
        for column in range(occupied.shape[1]):
            if occupied[row, column]:
                assert clearance[row, column] == -0.5
            else:
                expected = min(reach, distance(occupied, column + 0.5, row + 0.5))
                assert abs(clearance[row, column] - expected) < 1e-4


@given(GRIDS, st.floats(0.0, 20.0), st.floats(0.0, 20.0), st.floats(0.5, 4.0))
def test_compiled_distance_of_a_point_from_occupied_cells(occupied, x, y, reach):
    assert abs(square_distance(occupied, x, y, reach) - min(reach, distance(occupied, x, y))) < 1e-9
