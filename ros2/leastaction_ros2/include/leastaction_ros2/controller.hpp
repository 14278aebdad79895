/// \file
/// A learned model as a controller of ros2_control, whose interface is that of its version 4.27 (Jazzy).
#ifndef LEASTACTION_ROS2__CONTROLLER_HPP_
#define LEASTACTION_ROS2__CONTROLLER_HPP_

#include <controller_interface/controller_interface.hpp>
#include <memory>
#include <mutex>
#include <rclcpp/subscription.hpp>
#include <string>
#include <trajectory_msgs/msg/joint_trajectory_point.hpp>
#include <vector>

#include "leastaction_ros2/law.hpp"
#include "leastaction_ros2/settings.hpp"

namespace leastaction_ros2 {

/// Commands efforts from positions and velocities by a learned model: against gravity, by computed torque, or after a plan (Mode).
///
/// The safe state is no effort: after a state that is not finite or cannot be read, or a command that cannot be computed, every drive is
/// commanded 0, update returns ERROR, and this lasts until the controller is activated again. Deactivation commands 0, too.
///
/// References of the mode computed_torque come on `~/reference`, a trajectory_msgs/msg/JointTrajectoryPoint with positions, and if given
/// velocities and accelerations, of all joints in their order. Before the first one, the controller holds the position of its activation.
class Controller : public controller_interface::ControllerInterface {
public:
    using CallbackReturn = controller_interface::CallbackReturn;
    using Point = trajectory_msgs::msg::JointTrajectoryPoint;

    /// Declares the parameters.
    CallbackReturn on_init() override;

    /// `effort` of every driven joint.
    controller_interface::InterfaceConfiguration command_interface_configuration() const override;

    /// `position` and `velocity` of every joint.
    controller_interface::InterfaceConfiguration state_interface_configuration() const override;

    /// Reads parameters and files. FAILURE, with the reason in the log, leaves the controller unconfigured.
    CallbackReturn on_configure(const rclcpp_lifecycle::State & previous_state) override;

    /// Frees model, plan and subscription.
    CallbackReturn on_cleanup(const rclcpp_lifecycle::State & previous_state) override;

    /// Finds the interfaces, and takes the present position as the reference. FAILURE if the state is not finite.
    CallbackReturn on_activate(const rclcpp_lifecycle::State & previous_state) override;

    /// Commands no effort, and logs why update failed if it did.
    CallbackReturn on_deactivate(const rclcpp_lifecycle::State & previous_state) override;

    /// Writes the commands for the present state. Allocates nothing, waits for nothing, throws nothing.
    controller_interface::return_type update(const rclcpp::Time & time, const rclcpp::Duration & period) override;

private:
    /// Indices of a joint's interfaces among those that were lent; of the command only if something drives the joint.
    struct Indices {
        std::size_t position = 0;
        std::size_t velocity = 0;
        std::size_t effort = 0;
    };

    /// Why update failed.
    enum class Fault { none, position, velocity, law, effort };

    void accept(const Point & point);
    std::string wrong_with(const Point & point) const;
    bool find_interfaces();
    bool read(State & state);
    bool write(const Numbers & effort);
    bool failed(Fault fault, std::size_t number) noexcept;
    bool command(const rclcpp::Time & time, const rclcpp::Duration & period);
    void take_reference(double elapsed) noexcept;
    std::string fault_words() const;

    Settings settings_;
    std::unique_ptr<Law> law_;
    std::array<Indices, N> indices_{};
    rclcpp::Subscription<Point>::SharedPtr subscription_;

    // Written by the subscription's thread under the mutex, which update only tries to take.
    std::mutex pending_mutex_;
    Reference pending_;
    bool fresh_ = false;

    // The loop's own.
    Reference reference_;
    double age_ = 0.0;
    Fault fault_ = Fault::none;
    // The joint of a fault, or the law's status.
    std::size_t fault_number_ = 0;
};

}  // namespace leastaction_ros2

#endif  // LEASTACTION_ROS2__CONTROLLER_HPP_
