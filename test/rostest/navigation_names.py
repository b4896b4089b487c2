"""What the nodes of simulation.launch and navigation.launch offer: the names on the reference page in doc/."""

PUBLISHED = {
    "/move_base": {
        "/cmd_vel": "geometry_msgs/Twist",
        "/move_base/current_goal": "geometry_msgs/PoseStamped",
        "/move_base/recovery_status": "move_base_msgs/RecoveryStatus",
        "/move_base/GridPlanner/plan": "nav_msgs/Path",
        "/move_base/RolloutFollower/global_plan": "nav_msgs/Path",
        "/move_base/RolloutFollower/local_plan": "nav_msgs/Path",
        "/move_base/global_costmap/costmap": "nav_msgs/OccupancyGrid",
        "/move_base/global_costmap/costmap_updates": "map_msgs/OccupancyGridUpdate",
        "/move_base/global_costmap/footprint": "geometry_msgs/PolygonStamped",
        "/move_base/local_costmap/costmap": "nav_msgs/OccupancyGrid",
        "/move_base/local_costmap/costmap_updates": "map_msgs/OccupancyGridUpdate",
        "/move_base/local_costmap/footprint": "geometry_msgs/PolygonStamped",
        "/move_base/goal": "move_base_msgs/MoveBaseActionGoal",
        "/move_base/status": "actionlib_msgs/GoalStatusArray",
        "/move_base/feedback": "move_base_msgs/MoveBaseActionFeedback",
        "/move_base/result": "move_base_msgs/MoveBaseActionResult",
    },
    "/simulator": {
        "/clock": "rosgraph_msgs/Clock",
        "/tf": "tf2_msgs/TFMessage",
        "/odom": "nav_msgs/Odometry",
        "/base_pose_ground_truth": "nav_msgs/Odometry",
        "/base_scan": "sensor_msgs/LaserScan",
        "/simulator/collisions": "std_msgs/String",
    },
    "/map_server": {"/map": "nav_msgs/OccupancyGrid", "/map_metadata": "nav_msgs/MapMetaData"},
    "/fake_localization": {
        "/tf": "tf2_msgs/TFMessage",
        "/amcl_pose": "geometry_msgs/PoseWithCovarianceStamped",
        "/particlecloud": "geometry_msgs/PoseArray",
    },
}
SUBSCRIBED = {
    "/move_base": {"/map", "/relayed_scan", "/odom", "/tf", "/tf_static", "/move_base_simple/goal"},
    "/simulator": {"/cmd_vel"},
    "/map_server": set(),
    "/fake_localization": {"/relayed_truth", "/initialpose", "/tf", "/tf_static"},
}
SERVICES = {
    "/move_base": {"/move_base/make_plan", "/move_base/GridPlanner/make_plan", "/move_base/clear_costmaps"},
    "/simulator": {
        "/reset_positions",
        *(
            "/simulator/" + name
            for name in ("pause", "step", "set_speed", "set_door", "put_obstacle", "remove_obstacle", "set_pose")
        ),
    },
    "/map_server": {"/static_map", "/change_map"},
    "/fake_localization": set(),
}
