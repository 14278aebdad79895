/// \file
/// Parts of hardware_interface and controller_interface 4.27 (Jazzy) that the package uses, with the names and signatures of upstream, for
/// tests on machines without ROS 2. Never installed. Beyond upstream: a handle refers to a double of the test's hardware.
#ifndef STATED__CONTROL_HPP_
#define STATED__CONTROL_HPP_

#include <optional>
#include <utility>

#include "ros.hpp"

namespace hardware_interface {

constexpr char HW_IF_POSITION[] = "position";
constexpr char HW_IF_VELOCITY[] = "velocity";
constexpr char HW_IF_EFFORT[] = "effort";

/// A handle that is lent. `held` marks one that another thread holds: it can then neither be read nor written.
class Loaned {
public:
    Loaned(const std::string & name, double & value, const bool & held) : name_(name), value_(&value), held_(&held) {}
    Loaned(const Loaned &) = delete;
    Loaned(Loaned &&) = default;

    const std::string & get_name() const { return name_; }

    template <typename T = double>
    [[nodiscard]] std::optional<T> get_optional(unsigned int = 10) const {
        return *held_ ? std::nullopt : std::optional<T>(*value_);
    }

protected:
    std::string name_;
    double * value_;
    const bool * held_;
};

class LoanedStateInterface : public Loaned {
    using Loaned::Loaned;
};

class LoanedCommandInterface : public Loaned {
public:
    using Loaned::Loaned;

    template <typename T>
    [[nodiscard]] bool set_value(const T & value, unsigned int = 10) {
        if (!*held_) *value_ = value;
        return !*held_;
    }
};

}  // namespace hardware_interface

namespace controller_interface {

using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;

enum class return_type : std::uint8_t { OK = 0, ERROR = 1 };

enum class interface_configuration_type : std::uint8_t { ALL = 0, INDIVIDUAL = 1, NONE = 2 };

struct InterfaceConfiguration {
    interface_configuration_type type;
    std::vector<std::string> names = {};
};

class ControllerInterfaceBase : public rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface {
public:
    virtual InterfaceConfiguration command_interface_configuration() const = 0;
    virtual InterfaceConfiguration state_interface_configuration() const = 0;

    virtual void assign_interfaces(
        std::vector<hardware_interface::LoanedCommandInterface> && command_interfaces,
        std::vector<hardware_interface::LoanedStateInterface> && state_interfaces) {
        command_interfaces_ = std::move(command_interfaces);
        state_interfaces_ = std::move(state_interfaces);
    }

    virtual void release_interfaces() {
        command_interfaces_.clear();
        state_interfaces_.clear();
    }

    return_type init(
        const std::string & controller_name, const std::string &, unsigned int, const std::string &,
        const rclcpp::NodeOptions & node_options) {
        node_ = std::make_shared<rclcpp_lifecycle::LifecycleNode>(controller_name, node_options);
        return on_init() == CallbackReturn::SUCCESS ? return_type::OK : return_type::ERROR;
    }

    virtual CallbackReturn on_init() = 0;
    virtual return_type update(const rclcpp::Time & time, const rclcpp::Duration & period) = 0;

    std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() { return node_; }
    std::shared_ptr<const rclcpp_lifecycle::LifecycleNode> get_node() const { return node_; }

    template <typename ParameterT>
    auto auto_declare(const std::string & name, const ParameterT & default_value) {
        if (!node_->has_parameter(name)) return node_->template declare_parameter<ParameterT>(name, default_value);
        return ParameterT(node_->get_parameter(name).template get_value<ParameterT>());
    }

protected:
    std::vector<hardware_interface::LoanedCommandInterface> command_interfaces_;
    std::vector<hardware_interface::LoanedStateInterface> state_interfaces_;

private:
    std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node_;
};

class ControllerInterface : public ControllerInterfaceBase {};

}  // namespace controller_interface

#endif  // STATED__CONTROL_HPP_
