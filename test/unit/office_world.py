"""The office of the mailbot, modelled apart from its program."""

OFFICES = ("office1", "office2", "office3", "office4")


class World:
    """Where robot and packages are; ``places`` maps a package to its office, or to "robot"."""

    def __init__(self):
        self.robot = "office1"
        self.places = {}

    def do(self, action):
        """An action succeeds; AssertionError where it cannot be done."""
        name, what = action.interface_name, str(action.parameter)
        if name == "move_base":
            assert abs(OFFICES.index(what) - OFFICES.index(self.robot)) == 1, f"no way from {self.robot} to {what}"
            self.robot = what
        elif name == "pickup":
            assert self.places[what] == self.robot, f"package {what} is at {self.places[what]}"
            self.places[what] = "robot"
            assert list(self.places.values()).count("robot") <= 3, "more is carried than the robot can"
        else:
            assert name == "deliver"
            assert self.places[what] == "robot", f"package {what} is not carried"
            self.places[what] = self.robot
