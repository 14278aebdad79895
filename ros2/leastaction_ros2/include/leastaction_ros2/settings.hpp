/// \file
/// Parameters of the controller, read and checked.
#ifndef LEASTACTION_ROS2__SETTINGS_HPP_
#define LEASTACTION_ROS2__SETTINGS_HPP_

#include <array>
#include <cstdint>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>
#include <vector>

#include "leastaction_ros2/dynamics.hpp"

namespace leastaction_ros2 {

/// The controller's law.
enum class Mode {
    /// u = V_q: the robot stays where it is put.
    gravity,
    /// u = M (a_d + K_p e + K_d ė) + h: the robot follows references, e = q_d − q.
    computed_torque,
    /// u = ū − K (x − x̄): the robot follows a plan, and holds its end.
    follow,
};

/// Settings of the controller, each the parameter of its name.
struct Settings {
    Mode mode = Mode::gravity;
    /// Joints in the order of the model's coordinates.
    std::vector<std::string> joints;
    std::string model;
    std::string model_name;
    std::string plan;
    /// K_p, 1/s², and K_d, 1/s, of the mode computed_torque: a joint swings back with the angular frequency √K_p.
    std::array<double, N> kp{};
    std::array<double, N> kd{};
    /// Largest command by absolute value, N or N m. 0: nothing drives the joint, and no command interface is claimed.
    std::array<double, N> effort_limits{};
    /// Marks of joints whose encoder forgets whole turns before the start of a plan.
    std::array<std::uint8_t, N> forgets_turns{};
    /// Age of a reference, s, from which on only its position counts.
    double reference_timeout = 0.1;
};

/// Reads the settings from the node's parameters. Throws std::runtime_error with the name of the parameter that is wrong.
Settings read_settings(const rclcpp_lifecycle::LifecycleNode & node);

}  // namespace leastaction_ros2

#endif  // LEASTACTION_ROS2__SETTINGS_HPP_
