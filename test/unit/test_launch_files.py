"""The launch arguments that select the real stage_ros, move_base, map_server, or a user's own robot."""

import os
import shlex
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
import yaml

from rosoclingo.common.labels import LabelTable
from rosoclingo.common.reading import Reader
from rosoclingo.nodes.new_package import new_package

roslaunch = pytest.importorskip("roslaunch")
from roslaunch.config import ROSLaunchConfig  # noqa: E402
from roslaunch.core import RLException  # noqa: E402
from roslaunch.xmlloader import XmlLoader  # noqa: E402

pytestmark = pytest.mark.once
ROOT = Path(__file__).resolve().parents[2]
FILES = [*sorted((ROOT / "launch").glob("*.launch")), *(ROOT / "templates").rglob("*.launch")]
SIM = {"rosoclingo": ("rosoclingo", "simulator"), "stage": ("rosoclingo", "stage"), "none": None}
NAV = {"rosoclingo": ("rosoclingo", "move_base"), "move_base": ("move_base", "move_base"), "none": None}
MAP = {"rosoclingo": ("rosoclingo", "map_server"), "map_server": ("map_server", "map_server"), "none": None}
LOCALIZATION = {
    "rosoclingo": ("rosoclingo", "fake_localization"),
    "fake": ("fake_localization", "fake_localization"),
    "amcl": ("amcl", "amcl"),
    "none": None,
}
OWN = {("rosoclingo", name) for name in ("core", "office", "move_base_interface", "pickup_interface")}

# The parameters that move_base, costmap_2d and the two planners read on noetic; others would have no effect.
KNOWN = {
    "": {"base_global_planner", "base_local_planner", "controller_frequency", "planner_frequency"},
    "NavfnROS": {"allow_unknown", "default_tolerance"},
    "DWAPlannerROS": {
        "max_vel_trans", "min_vel_trans", "max_vel_x", "min_vel_x", "max_vel_y", "min_vel_y", "max_vel_theta",
        "min_vel_theta", "acc_lim_x", "acc_lim_y", "acc_lim_theta", "acc_lim_trans", "xy_goal_tolerance",
        "yaw_goal_tolerance", "sim_time", "vx_samples", "vy_samples", "vth_samples",
    },
    "costmap": {
        "global_frame", "robot_base_frame", "robot_radius", "update_frequency", "publish_frequency", "plugins",
        "rolling_window", "width", "height", "transform_tolerance",
    },
    "layer": {"observation_sources", "obstacle_range", "raytrace_range", "inflation_radius", "cost_scaling_factor"},
    "source": {"topic", "data_type", "marking", "clearing", "expected_update_rate"},
}  # fmt: skip


def load(name, **arguments):
    """Return the configuration that roslaunch makes of a launch file and its arguments."""
    words = [f"{key}:={value}" for key, value in arguments.items()]
    config = ROSLaunchConfig()
    XmlLoader(resolve_anon=False).load(str(ROOT / "launch" / name), config, argv=words, verbose=False)
    return config


@pytest.mark.parametrize(
    ("encoding", "files"),
    [({}, ["mailbot.lp", "office.lp"]), ({"encoding": "paper"}, ["paper.lp"]), ({"programs": "[a/b.lp]"}, ["b.lp"])],
)
def test_launch_mailbot_has_its_encoding(encoding, files):
    programs = parameters(load("mailbot.launch", **encoding), "/rosoclingo/program_files")[""]
    assert [Path(file).name for file in programs] == files


def template(monkeypatch, folder, **arguments):
    """Return the configuration of a new package's launch file."""
    new_package("guard", folder, ROOT / "templates" / "package")
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{folder}:{os.environ.get('ROS_PACKAGE_PATH', '')}")
    monkeypatch.setattr(roslaunch.substitution_args, "_rospack", None)
    return load(folder / "guard" / "launch" / "guard.launch", **arguments)


def test_template_launch_has_the_usual_arguments(monkeypatch, tmp_path):
    config = template(monkeypatch, tmp_path)
    assert not {"web", "record"} & {one.type for one in config.nodes}, "unasked"
    assert parameters(config, "/rosoclingo/")["plan"] == "soon"
    given = {"plan": "shortest", "preempt": "true", "web": "true", "port": 8123, "record": "true", "bag": "a.bag"}
    config = load(tmp_path / "guard" / "launch" / "guard.launch", **given)
    assert {one.type for one in config.nodes} >= {"core", "interface", "web", "record"}
    assert {"/rosoclingo/", "/interfaces/", "/web/", "/record/"} <= set(config.clear_params)
    core, web = parameters(config, "/rosoclingo/"), parameters(config, "/web/")
    assert (core["plan"], core["preempt"]) == ("shortest", True)
    assert parameters(config, "/record/") == {"bag": "a.bag"}
    assert (web["port"], web["title"], web["orders"][0]["goal"]) == (8123, "guard", "visit({place})")


def nodes(config):
    return {(node.package, node.type) for node in config.nodes}


def node(config, name):
    return next(node for node in config.nodes if node.name == name)


def words(config, name):
    """Return the arguments of a node as roslaunch passes them."""
    return shlex.split(node(config, name).args)


def parameters(config, prefix):
    return {key[len(prefix) :]: value.value for key, value in config.params.items() if key.startswith(prefix)}


@pytest.mark.parametrize("sim", SIM)
def test_launch_simulation_can_be_replaced(sim):
    config = load("simulation.launch", sim=sim)
    assert nodes(config) == ({SIM[sim]} - {None})
    assert ("/use_sim_time" in config.params) == (sim != "none")


CHOICES = {"nav": NAV, "map_server": MAP, "localization": LOCALIZATION}


@pytest.mark.parametrize(("argument", "value"), [(key, value) for key in CHOICES for value in CHOICES[key]])
def test_launch_navigation_can_be_replaced(argument, value):
    choice = {"nav": "none", "map_server": "none", "localization": "none", argument: value}
    config = load("navigation.launch", **choice)
    assert nodes(config) == {CHOICES[argument][value]} - {None}
    assert {node.namespace for node in config.nodes} <= {"/"}


@pytest.mark.parametrize(
    ("sim", "nav", "server", "localization"),
    [("rosoclingo", "rosoclingo", "none", "none"), ("stage", "move_base", "map_server", "fake"), ("none",) * 4],
)
def test_launch_mailbot_passes_its_arguments_through(sim, nav, server, localization):
    found = nodes(load("mailbot.launch", sim=sim, nav=nav, map_server=server, localization=localization))
    wanted = {SIM[sim], NAV[nav], MAP[server], LOCALIZATION[localization]} - {None}
    unwanted = {pair for table in (SIM, *CHOICES.values()) for pair in table.values() if pair}
    assert found >= OWN
    assert found & unwanted == wanted


@pytest.mark.parametrize("file", ["core.launch", "mailbot_day.launch"])
@pytest.mark.parametrize(
    ("given", "again", "journal", "resume"),
    [
        ({"resume": "yes"}, True, "auto", "yes"),
        ({"journal": "/tmp/kept", "RESPAWN": "false"}, False, "/tmp/kept", "ask"),
        ({"journal": "none"}, False, "none", "ask"),
        ({"journal": "none", "RESPAWN": "true"}, True, "none", "ask"),
    ],
)
def test_launch_core_respawns_or_ends_the_launch(file, given, again, journal, resume):
    respawn = "respawn" if file == "core.launch" else "core_respawn"
    config = load(file, **{respawn if key == "RESPAWN" else key: value for key, value in given.items()})
    core = node(config, "rosoclingo")
    assert (core.respawn, core.required) == (again, not again)
    found = parameters(config, "/rosoclingo/")
    assert (found["journal"], found["resume"], found["required"]) == (journal, resume, True)
    assert file == "core.launch" or node(config, "pickup_interface").respawn


@pytest.mark.slow
def test_launch_floor_is_made_of_a_map():
    found = parameters(
        load("mailbot.launch", places=str(ROOT / "worlds" / "office.yaml"), start="office1"), "/rosoclingo/"
    )
    assert "connection(office1,office2)." in found["places"]
    assert found["places"].endswith("start(office1).\n")
    assert "places" not in parameters(load("mailbot.launch"), "/rosoclingo/")

    with pytest.raises(RLException, match="places"):
        load("core.launch", places=str(ROOT / "worlds" / "office.yaml"), start="office9")


@pytest.mark.parametrize(
    ("file", "argument"),
    [
        ("mailbot.launch", "sim"),
        ("mailbot.launch", "nav"),
        ("navigation.launch", "map_server"),
        ("navigation.launch", "localization"),
    ],
)
def test_launch_unknown_choice_lists_the_known_ones(file, argument):
    with pytest.raises(roslaunch.xmlloader.XmlParseException) as caught:
        load(file, **{argument: "gazebo"})
    assert "gazebo" in str(caught.value)
    assert argument in str(caught.value)
    assert "rosoclingo" in str(caught.value)


@pytest.mark.parametrize("robots", [1, 3, 17])
def test_launch_fleet_names_each_robot(robots):
    found = parameters(load("fleet.launch", robots=robots), "/")
    names = [f"r{number}" for number in range(1, robots + 1)]
    assert (found["office/robots"], found["interfaces/values/R"]) == (names, names)


@pytest.mark.parametrize("robots", [0, 100])
def test_launch_fleet_reports_an_impossible_number_of_robots(robots):
    with pytest.raises(roslaunch.xmlloader.XmlParseException, match=f"robots is not .* from 1 to 99: {robots}"):
        load("fleet.launch", robots=robots)


def test_launch_passes_arguments_to_stage():
    def stage(**more):
        return load("mailbot.launch", sim="stage", stage_world="/a.world", **more)

    assert words(stage(speed="0"), "stageros") == ["--speed", "0", "/a.world"]
    assert words(stage(stage_args="-g"), "stageros") == ["--speed", "1.0", "-g", "/a.world"]
    assert words(stage(stage_window="true"), "stageros") == ["--speed", "1.0", "--window", "/a.world"]
    assert not node(stage(), "stageros").remap_args


def test_launch_passes_arguments_of_simulation_to_stage():
    given = {"base_watchdog_timeout": "0.5", "use_model_names": "true"}
    config = load("simulation.launch", sim="stage", **given)
    *options, world = words(config, "stageros")
    assert options == ["--speed", "1.0", "-u"]
    assert Path(world).resolve() == ROOT / "worlds" / "office.world"
    assert parameters(config, "/stageros/") == {"base_watchdog_timeout": 0.5}


@pytest.mark.parametrize(
    ("file", "servers"),
    [
        ("mailbot.launch", ["move_base", "pickup", "deliver"]),
        ("fleet.launch", ["r1/move_base", "r1/pickup", "r1/deliver"]),
    ],
)
def test_launch_plays_a_scenario(file, servers):
    expected = ["--wait-for", *servers, "--", "paper"]
    assert words(load(file, scenario="paper"), "play_scenario") == expected
    assert words(load(file, scenario="paper", record="true"), "play_scenario") == ["--recorder", *expected]


def test_launch_delays_the_scans():
    for file in ("simulation.launch", "mailbot.launch", "house.launch"):
        assert "/simulator/scan_delay" not in load(file).params
        assert load(file, scan_delay="0.1").params["/simulator/scan_delay"].value == 0.1


@pytest.mark.parametrize(
    ("file", "argument", "name", "given"),
    [
        ("navigation.launch", "map", "map_server", {}),
        ("navigation.launch", "map", "map_server", {"map_server": "map_server"}),
        ("mailbot.launch", "scenario", "play_scenario", {}),
        ("fleet.launch", "scenario", "play_scenario", {}),
        ("simulation.launch", "stage_world", "stageros", {"sim": "stage"}),
        ("rviz.launch", "config", "rviz", {}),
    ],
)
def test_launch_passes_a_file_with_blanks(file, argument, name, given):
    assert "/my work/a file" in words(load(file, **given, **{argument: "/my work/a file"}), name)


def test_launch_passes_frames_to_localization():
    """The default of fake_localization for the map's frame begins with a slash, which tf2 refuses to look up."""
    found = parameters(load("navigation.launch", localization="fake"), "/fake_localization/")
    assert found == {"global_frame_id": "map", "odom_frame_id": "odom", "base_frame_id": "base_link"}
    config = load("navigation.launch", localization="amcl", initial_pose="1 -2 0.5")
    found = parameters(config, "/amcl/")
    assert (found["initial_pose_x"], found["initial_pose_y"], found["initial_pose_a"]) == (1.0, -2.0, 0.5)
    assert (found["odom_frame_id"], found["base_frame_id"]) == ("odom", "base_link")
    assert [tuple(pair) for pair in node(config, "amcl").remap_args] == [("scan", "base_scan")]


@pytest.mark.parametrize(("nav", "localization"), [("rosoclingo", "rosoclingo"), ("move_base", "amcl")])
def test_launch_starts_one_of_several_robots(nav, localization):
    config = load("navigation.launch", nav=nav, localization=localization, frame_prefix="robot_1/")
    name = "amcl" if localization == "amcl" else "fake_localization"
    found = parameters(config, f"/{name}/")
    assert (found["odom_frame_id"], found["base_frame_id"]) == ("robot_1/odom", "robot_1/base_link")
    found = parameters(config, "/move_base/")
    assert found["global_costmap/global_frame"] == "map"
    assert found["global_costmap/robot_base_frame"] == "robot_1/base_link"
    assert found["local_costmap/global_frame"] == "robot_1/odom"


def test_launch_real_move_base_reads_every_parameter():
    values = yaml.safe_load((ROOT / "config" / "real_move_base.yaml").read_text())
    for key, value in values.items():
        if not key.endswith("_costmap"):
            names, known = ({key}, KNOWN[""]) if not isinstance(value, dict) else (set(value), KNOWN[key])
            assert names <= known
            continue
        layers = {plugin["name"] for plugin in value["plugins"]}
        assert set(value) - layers <= KNOWN["costmap"]
        # clear_costmap_recovery clears the layer "obstacles" unless configured otherwise.
        assert "obstacles" in layers
        for layer in layers & set(value):
            sources = set(value[layer].get("observation_sources", "").split())
            assert set(value[layer]) - sources <= KNOWN["layer"]
            assert all(set(value[layer][source]) <= KNOWN["source"] for source in sources)


def test_launch_custom_configuration_keeps_its_frames(tmp_path):
    (tmp_path / "own.yaml").write_text("global_costmap: {robot_base_frame: base_footprint}")
    for nav, argument in (("rosoclingo", "navigation_config"), ("move_base", "move_base_config")):
        config = load("navigation.launch", nav=nav, **{argument: tmp_path / "own.yaml"})
        assert parameters(config, "/move_base/") == {"global_costmap/robot_base_frame": "base_footprint"}


def test_launch_hosts_has_only_the_core_here():
    config = load("hosts.launch", robot="10.0.0.2", env_loader="/home/robot/env.sh", sim="none")
    machine = config.machines["robot"]
    assert (machine.address, machine.env_loader) == ("10.0.0.2", "/home/robot/env.sh")
    assert {one.name for one in config.nodes if one.machine_name is None} == {"rosoclingo"}
    assert {one.name for one in config.nodes if one.machine_name == "robot"} >= {"move_base", "move_base_interface"}


@pytest.mark.parametrize(("given", "robots"), [({}, 3), ({"robots": "5"}, 5)])
def test_launch_fleet_has_navigation_for_each_robot(given, robots):
    config = load("fleet.launch", **given)
    names = [f"r{number}" for number in range(1, robots + 1)]
    assert sorted(one.namespace for one in config.nodes if one.type == "move_base") == [f"/{name}/" for name in names]
    assert parameters(config, "/interfaces/values/")["R"] == names


def test_launch_household_gives_each_robot_poses_of_its_own():
    config = load("household.launch")
    assert [one.namespace for one in config.nodes if one.type == "interface"] == ["/r1/", "/r2/"]
    shared = LabelTable.read(Reader(yaml.safe_load((ROOT / "config" / "house_labels.yaml").read_text())))
    for robot, side in (("r1", -0.4), ("r2", 0.4)):
        found = parameters(config, f"/{robot}/interfaces/labels/")
        # both count as being at the label, which is the middle of the room
        assert found == {one.name: [pytest.approx(one.x + side), one.y] for one in shared}
    files = parameters(config, "/rosoclingo/program_files")[""]
    assert [Path(one).name for one in files] == ["household.lp", "home.lp"]


def test_launch_fleet_can_do_without_its_interfaces():
    assert "interface" in {one.type for one in load("fleet.launch").nodes}
    assert "interface" not in {one.type for one in load("fleet.launch", interfaces="none").nodes}


@pytest.mark.parametrize("file", FILES, ids=[file.name for file in FILES])
def test_launch_arguments_can_be_given_as_documented(file):
    """The command line of roslaunch ignores ``name:=``, so that only a default can be empty."""
    for argument in ElementTree.parse(file).getroot().iter("arg"):
        assert "empty:" not in argument.get("doc", "") or argument.get("default") == "", argument.get("name")


def test_launch_both_configurations_describe_same_robot():
    own, real = (
        yaml.safe_load((ROOT / "config" / name).read_text()) for name in ("navigation.yaml", "real_move_base.yaml")
    )
    world = yaml.safe_load((ROOT / "worlds" / "office_world.yaml").read_text())["robots"][0]
    assert own["global_costmap"]["robot_radius"] == world["radius"]
    assert {real[name]["robot_radius"] for name in ("global_costmap", "local_costmap")} == {world["radius"]}
    assert real["DWAPlannerROS"]["max_vel_x"] <= world["max_speed"]
    assert own["RolloutFollower"]["max_vel_x"] <= world["max_speed"]


def test_launch_removes_labels_and_packages_of_earlier_launch():
    """The server merges maps of parameters: a house's things would be in the office of the next launch."""
    config = load("mailbot.launch", rviz="true")
    keys = [key.split("/") for key in config.params if key.count("/") > 1]
    loaded = {key[1] for key in keys if key[2] in ("labels", "packages", "interfaces")}
    assert {"rosoclingo", "office", "markers", "move_base_interface", "pickup_interface"} <= loaded
    assert {f"/{name}/" for name in loaded} <= set(config.clear_params)
