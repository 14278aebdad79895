/// \file
/// The controller's laws, from a measured state to commands, without ROS.
#ifndef LEASTACTION_ROS2__LAW_HPP_
#define LEASTACTION_ROS2__LAW_HPP_

#include <array>
#include <cstdint>
#include <memory>

#include "leastaction_ros2/dynamics.hpp"
#include "leastaction_ros2/settings.hpp"

namespace leastaction_ros2 {

/// Numbers of all joints in the precision of hardware interfaces.
using Numbers = std::array<double, N>;

/// A measured state: position, m or rad, velocity, m/s or rad/s, and its time, ns.
struct State {
    Numbers q{};
    Numbers v{};
    std::int64_t time = 0;
};

/// A reference: position, velocity and acceleration that the robot should have now.
struct Reference {
    Numbers q{};
    Numbers v{};
    Numbers a{};
};

/// A law over a model, and a plan where it needs one.
class Law {
public:
    /// Loads model and plan. Throws std::runtime_error if a file is refused, if a drive has no positive gain, and if the plan may command
    /// more than a drive's limit.
    explicit Law(const Settings & settings);

    /// Begins anew: the next command is the first of the plan.
    void begin() noexcept { begun_ = false; }

    /// Writes the commands for a state, N or N m, within the limits: 0 for joints without a drive. They are those of the model's
    /// actuator, as in its log. Allocates nothing. On another status than OK the commands are unchanged.
    leastaction_status command(const State & now, const Reference & reference, Numbers & effort) noexcept;

private:
    leastaction_status computed_torque(const State & now, const Reference & reference, Vector & force) const noexcept;
    leastaction_status follow(const State & now, Vector & u) noexcept;
    void check_plan() const;

    Settings settings_;
    Model model_;
    Drives drives_;
    std::unique_ptr<const Plan> plan_;
    bool begun_ = false;
    std::int64_t start_ = 0;
    Vector turns_{};
};

}  // namespace leastaction_ros2

#endif  // LEASTACTION_ROS2__LAW_HPP_
