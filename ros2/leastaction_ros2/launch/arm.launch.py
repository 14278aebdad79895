"""Starts a controller manager for a robot's description, and the controller of config/arm.yaml.

ros2 launch leastaction_ros2 arm.launch.py description:=arm.urdf [parameters:=arm.yaml]

The description needs a <ros2_control> element whose hardware has the command interface `effort` and the state interfaces
`position` and `velocity` for every joint.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import Command, LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    parameters = LaunchConfiguration("parameters")
    description = ParameterValue(Command(["cat ", LaunchConfiguration("description")]), value_type=str)
    given = PathJoinSubstitution([FindPackageShare("leastaction_ros2"), "config", "arm.yaml"])
    return LaunchDescription([
        DeclareLaunchArgument("description", description="Path of the robot's URDF"),
        DeclareLaunchArgument("parameters", default_value=given, description="Parameters of manager and controller"),
        Node(package="robot_state_publisher", executable="robot_state_publisher", parameters=[{"robot_description": description}]),
        Node(package="controller_manager", executable="ros2_control_node", parameters=[parameters], output="screen"),
        Node(package="controller_manager", executable="spawner", arguments=["arm", "--param-file", parameters]),
    ])
