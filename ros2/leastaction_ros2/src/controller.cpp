#include "leastaction_ros2/controller.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <hardware_interface/types/hardware_interface_type_values.hpp>
#include <limits>
#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/logging.hpp>
#include <rclcpp/qos.hpp>

namespace leastaction_ros2 {

namespace {

using controller_interface::interface_configuration_type;
using controller_interface::InterfaceConfiguration;
using controller_interface::return_type;
using hardware_interface::HW_IF_EFFORT;
using hardware_interface::HW_IF_POSITION;
using hardware_interface::HW_IF_VELOCITY;

/// Finds an interface among those that were lent; false if it is not there.
template <typename Interfaces>
bool find(const Interfaces & interfaces, const std::string & name, std::size_t & index) {
    const auto found =
        std::find_if(interfaces.begin(), interfaces.end(), [&](const auto & each) { return each.get_name() == name; });
    index = static_cast<std::size_t>(found - interfaces.begin());
    return found != interfaces.end();
}

/// Reads an interface; NaN if another thread holds it.
template <typename Interface>
double value(const Interface & interface) {
    return interface.get_optional().value_or(std::numeric_limits<double>::quiet_NaN());
}

/// A number is usable if it is finite in the library's precision.
bool usable(double x) noexcept {
    return std::abs(x) <= static_cast<double>(std::numeric_limits<float>::max());
}

bool all_usable(const std::vector<double> & x) {
    return std::all_of(x.begin(), x.end(), usable);
}

Numbers or_zeros(const std::vector<double> & x) {
    Numbers y{};
    std::copy(x.begin(), x.end(), y.begin());
    return y;
}

}  // namespace

Controller::CallbackReturn Controller::on_init() {
    try {
        auto_declare<std::string>("mode", "gravity");
        auto_declare<std::vector<std::string>>("joints", {});
        auto_declare<std::string>("model", "");
        auto_declare<std::string>("model_name", "");
        auto_declare<std::string>("plan", "");
        auto_declare<std::vector<double>>("kp", {});
        auto_declare<std::vector<double>>("kd", {});
        auto_declare<std::vector<double>>("effort_limits", {});
        auto_declare<std::vector<std::string>>("forgets_turns", {});
        auto_declare<double>("reference_timeout", Settings{}.reference_timeout);
    } catch (const std::exception & error) {
        RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
        return CallbackReturn::ERROR;
    }
    return CallbackReturn::SUCCESS;
}

InterfaceConfiguration Controller::command_interface_configuration() const {
    InterfaceConfiguration configuration{interface_configuration_type::INDIVIDUAL, {}};
    for (std::size_t i = 0; i < settings_.joints.size(); i++) {
        if (settings_.effort_limits[i] > 0.0) configuration.names.push_back(settings_.joints[i] + "/" + HW_IF_EFFORT);
    }
    return configuration;
}

InterfaceConfiguration Controller::state_interface_configuration() const {
    InterfaceConfiguration configuration{interface_configuration_type::INDIVIDUAL, {}};
    for (const auto & joint : settings_.joints) {
        configuration.names.push_back(joint + "/" + HW_IF_POSITION);
        configuration.names.push_back(joint + "/" + HW_IF_VELOCITY);
    }
    return configuration;
}

Controller::CallbackReturn Controller::on_configure(const rclcpp_lifecycle::State &) {
    try {
        const Settings settings = read_settings(*get_node());
        law_ = std::make_unique<Law>(settings);
        settings_ = settings;
        subscription_ = nullptr;
        if (settings.mode == Mode::computed_torque) {
            subscription_ = get_node()->create_subscription<Point>(
                "~/reference", rclcpp::SystemDefaultsQoS(), [this](const Point & point) { accept(point); });
        }
    } catch (const std::exception & error) {
        RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
        return CallbackReturn::FAILURE;
    }
    return CallbackReturn::SUCCESS;
}

Controller::CallbackReturn Controller::on_cleanup(const rclcpp_lifecycle::State &) {
    subscription_ = nullptr;
    law_ = nullptr;
    settings_ = Settings{};
    return CallbackReturn::SUCCESS;
}

bool Controller::find_interfaces() {
    for (std::size_t i = 0; i < N; i++) {
        const std::string joint = settings_.joints[i] + "/";
        Indices & at = indices_[i];
        if (!find(state_interfaces_, joint + HW_IF_POSITION, at.position) || !find(state_interfaces_, joint + HW_IF_VELOCITY, at.velocity)
            || (settings_.effort_limits[i] > 0.0 && !find(command_interfaces_, joint + HW_IF_EFFORT, at.effort))) {
            RCLCPP_ERROR(get_node()->get_logger(), "an interface of joint '%s' is missing", settings_.joints[i].c_str());
            return false;
        }
    }
    return true;
}

Controller::CallbackReturn Controller::on_activate(const rclcpp_lifecycle::State &) {
    fault_ = Fault::none;
    State state;
    if (law_ == nullptr || !find_interfaces()) return CallbackReturn::FAILURE;
    if (!read(state)) {
        RCLCPP_ERROR(get_node()->get_logger(), "not activated: %s", fault_words().c_str());
        return CallbackReturn::FAILURE;
    }
    const std::lock_guard<std::mutex> lock(pending_mutex_);
    fresh_ = false;
    reference_ = {state.q, {}, {}};
    age_ = 0.0;
    law_->begin();
    return CallbackReturn::SUCCESS;
}

Controller::CallbackReturn Controller::on_deactivate(const rclcpp_lifecycle::State &) {
    write({});
    if (fault_ != Fault::none) RCLCPP_ERROR(get_node()->get_logger(), "stopped: %s", fault_words().c_str());
    return CallbackReturn::SUCCESS;
}

return_type Controller::update(const rclcpp::Time & time, const rclcpp::Duration & period) {
    if (fault_ == Fault::none && command(time, period)) return return_type::OK;
    write({});
    return return_type::ERROR;
}

bool Controller::command(const rclcpp::Time & time, const rclcpp::Duration & period) {
    State state;
    state.time = time.nanoseconds();
    if (!read(state)) return false;
    take_reference(1e-9 * static_cast<double>(period.nanoseconds()));
    Numbers effort{};
    const auto status = law_->command(state, reference_, effort);
    if (status != LEASTACTION_STATUS_OK) return failed(Fault::law, static_cast<std::size_t>(status));
    return write(effort);
}

bool Controller::read(State & state) {
    for (std::size_t i = 0; i < N; i++) {
        state.q[i] = value(state_interfaces_[indices_[i].position]);
        state.v[i] = value(state_interfaces_[indices_[i].velocity]);
        if (!usable(state.q[i])) return failed(Fault::position, i);
        if (!usable(state.v[i])) return failed(Fault::velocity, i);
    }
    return true;
}

bool Controller::write(const Numbers & effort) {
    bool written = true;
    for (std::size_t i = 0; i < N; i++) {
        if (settings_.effort_limits[i] > 0.0 && !command_interfaces_[indices_[i].effort].set_value(effort[i])) {
            written = failed(Fault::effort, i);
        }
    }
    return written;
}

bool Controller::failed(Fault fault, std::size_t number) noexcept {
    if (fault_ == Fault::none) {
        fault_ = fault;
        fault_number_ = number;
    }
    return false;
}

void Controller::take_reference(double elapsed) noexcept {
    age_ += elapsed;
    const std::unique_lock<std::mutex> lock(pending_mutex_, std::try_to_lock);
    if (lock.owns_lock() && fresh_) {
        reference_ = pending_;
        fresh_ = false;
        age_ = 0.0;
    }
    // Who sends no more references has stopped: a velocity that lasted would pull the robot along.
    if (age_ > settings_.reference_timeout) reference_.v = reference_.a = {};
}

std::string Controller::wrong_with(const Point & point) const {
    const auto optional = [](const std::vector<double> & x) { return x.empty() || x.size() == N; };
    if (point.positions.size() != N || !optional(point.velocities) || !optional(point.accelerations)) {
        return "it needs " + std::to_string(N) + " positions, and none or as many velocities and accelerations";
    }
    if (!all_usable(point.positions) || !all_usable(point.velocities) || !all_usable(point.accelerations)) {
        return "a number is not finite";
    }
    return "";
}

void Controller::accept(const Point & point) {
    const std::string wrong = wrong_with(point);
    if (!wrong.empty()) {
        RCLCPP_WARN(get_node()->get_logger(), "a reference was ignored: %s", wrong.c_str());
        return;
    }
    const std::lock_guard<std::mutex> lock(pending_mutex_);
    pending_ = {or_zeros(point.positions), or_zeros(point.velocities), or_zeros(point.accelerations)};
    fresh_ = true;
}

std::string Controller::fault_words() const {
    const auto joint = [this] { return "joint '" + settings_.joints[fault_number_] + "'"; };
    switch (fault_) {
        case Fault::none: break;
        case Fault::position: return "the position of " + joint() + " is not a number, or cannot be read";
        case Fault::velocity: return "the velocity of " + joint() + " is not a number, or cannot be read";
        case Fault::effort: return "the effort of " + joint() + " cannot be written";
        case Fault::law: return leastaction_message(static_cast<int>(fault_number_));
    }
    return "no fault";
}

}  // namespace leastaction_ros2

PLUGINLIB_EXPORT_CLASS(leastaction_ros2::Controller, controller_interface::ControllerInterface)
