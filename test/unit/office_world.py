"""The office of the mailbot, and any other floor, modelled independently of the program."""

from mailbot_world import fewest_steps

OFFICES = ("office1", "office2", "office3", "office4")


class World:
    """The positions of robot and packages; ``places`` maps a package to its office, or to "robot"."""

    def __init__(self):
        self.robot = "office1"
        self.places = {}

    def do(self, action):
        """Execute a successful action; AssertionError if it is impossible."""
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


class Office:
    """Positions of robot and packages: each waits, ``("waits", from, to)``, rides, ``("rides", to)``, or is done."""

    def __init__(self, graph, capacity, robot, packages=None):
        self.graph, self.capacity, self.robot, self.packages = graph, capacity, robot, dict(packages or {})

    def copy(self):
        """Return a copy of the office for trials."""
        return Office(self.graph, self.capacity, self.robot, self.packages)

    def do(self, action):
        """Execute an action; AssertionError if it is impossible."""
        name, what = action.interface_name, str(action.parameter)
        if name == "move_base":
            assert what in self.graph[self.robot]
            self.robot = what
            return
        place = self.packages[int(what)]
        if name == "pickup":
            assert place[:2] == ("waits", self.robot)
            assert sum(bool(one) and one[0] == "rides" for one in self.packages.values()) < self.capacity
            self.packages[int(what)] = ("rides", place[2])
        else:
            assert (name, place) == ("deliver", ("rides", self.robot))
            self.packages[int(what)] = None

    def judge(self, plan, cycle):
        """Check that the rest of a plan brings every package to its destination; return the number of its steps."""
        office, rest = self.copy(), sorted((one for one in plan if one.cycle >= cycle), key=lambda one: one.cycle)
        assert [one.cycle for one in rest] == sorted({one.cycle for one in rest}), "the robot does one thing at a time"
        for action in rest:
            office.do(action)
        assert set(office.packages.values()) <= {None}
        return rest[-1].cycle - cycle + 1 if rest else 0

    def fewest(self):
        """Return the fewest steps of a plan."""
        return fewest_steps(self.graph, self.capacity, self.robot, tuple(self.packages.values()))
