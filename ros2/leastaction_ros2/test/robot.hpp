/// \file
/// Fake hardware: interfaces that are doubles, behind them a robot that moves by the model's own steps.
#ifndef TEST__ROBOT_HPP_
#define TEST__ROBOT_HPP_

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "leastaction_ros2/controller.hpp"

namespace test {

using leastaction_ros2::Controller;
using leastaction_ros2::N;
using leastaction_ros2::Numbers;
using leastaction_ros2::Vector;
using controller_interface::return_type;
using CallbackReturn = Controller::CallbackReturn;
using Parameters = std::vector<rclcpp::Parameter>;

/// Ends the test with a line about a condition that does not hold.
#define CHECK(condition, ...)                                              \
    do {                                                                   \
        if (!(condition)) {                                                \
            std::fprintf(stderr, "%s:%d: %s: ", __FILE__, __LINE__, #condition); \
            std::fprintf(stderr, __VA_ARGS__);                             \
            std::fputs("\n", stderr);                                      \
            std::exit(1);                                                  \
        }                                                                  \
    } while (false)

/// Names of the joints of the arm.
inline std::vector<std::string> joints() {
    return {"shoulder_turn", "shoulder_lift", "elbow", "wrist_roll", "wrist_pitch", "flange_turn"};
}

/// Limits of the drives, N m.
inline std::vector<double> limits() {
    return {120, 120, 60, 20, 20, 20};
}

/// Parameters of a mode that are right for the arm.
inline Parameters parameters(const std::string & files, const std::string & mode) {
    return {
        {"mode", mode},
        {"joints", joints()},
        {"model", files + "/arm.postcard"},
        {"plan", files + "/reach.postcard"},
        {"effort_limits", limits()},
        {"kp", std::vector<double>(N, 400.0)},
        {"kd", std::vector<double>(N, 40.0)},
    };
}

/// Parameters with one that is replaced or added.
inline Parameters with(Parameters parameters, const rclcpp::Parameter & parameter) {
    for (auto & each : parameters) {
        if (each.get_name() == parameter.get_name()) {
            each = parameter;
            return parameters;
        }
    }
    parameters.push_back(parameter);
    return parameters;
}

/// The robot: its model, its state, and the doubles of its interfaces.
class Robot {
public:
    const double h;

    /// A robot with these joints at rest at `start`, and the length h of a step, s: the controller's period.
    Robot(const std::string & model, std::vector<std::string> joints, const Numbers & start, double h = 0.005)
    : h(h), model_(model), joints_(std::move(joints)), q(start) {
        Vector at, rest{};
        for (std::size_t i = 0; i < N; i++) at[i] = static_cast<float>(start[i]);
        CHECK(leastaction_start(model_.get(), &state_, at.data(), rest.data(), N, nullptr) == LEASTACTION_STATUS_OK, "start");
    }

    /// Moves by one step under the forces that the drives make of the commanded efforts.
    void step() {
        Vector u, u0, u1, position, velocity;
        for (std::size_t i = 0; i < N; i++) u[i] = static_cast<float>(effort[i]);
        leastaction_error error{};
        leastaction_actuate(model_.get(), static_cast<float>(h), before_.data(), u.data(), N, u0.data(), u1.data(), &error);
        CHECK(error.status == LEASTACTION_STATUS_OK, "%s", leastaction_ros2::words(error).c_str());
        leastaction_step2(model_.get(), &state_, static_cast<float>(h), u0.data(), u1.data(), N, nullptr, nullptr, &error);
        CHECK(error.status == LEASTACTION_STATUS_OK, "%s", leastaction_ros2::words(error).c_str());
        before_ = u;
        leastaction_state_q(&state_, N, position.data(), nullptr);
        leastaction_state_w(&state_, N, velocity.data(), nullptr);
        for (std::size_t i = 0; i < N; i++) {
            q[i] = static_cast<double>(position[i]);
            v[i] = static_cast<double>(velocity[i]);
        }
    }

    const leastaction_ros2::Model & model() const { return model_; }

    /// Lends the interfaces that a controller asks for, in reverse order: it must go by their names.
    void lend(Controller & controller) {
        std::vector<hardware_interface::LoanedStateInterface> states;
        std::vector<hardware_interface::LoanedCommandInterface> commands;
        const auto asked = controller.state_interface_configuration().names;
        for (auto name = asked.rbegin(); name != asked.rend(); ++name) states.emplace_back(*name, place(*name), held);
        const auto driven = controller.command_interface_configuration().names;
        for (auto name = driven.rbegin(); name != driven.rend(); ++name) commands.emplace_back(*name, place(*name), held);
        controller.assign_interfaces(std::move(commands), std::move(states));
    }

private:
    double & place(const std::string & name) {
        const auto slash = name.find('/');
        std::size_t i = 0;
        while (joints_.at(i) != name.substr(0, slash)) i++;
        const std::string kind = name.substr(slash + 1);
        CHECK(kind == "position" || kind == "velocity" || kind == "effort", "%s", name.c_str());
        return kind == "position" ? q[i] : kind == "velocity" ? v[i] : effort[i];
    }

    leastaction_ros2::Model model_;
    leastaction_state state_{};
    std::vector<std::string> joints_;
    Vector before_{};

public:
    Numbers q{}, v{}, effort{};
    bool held = false;
};

/// A controller, and the loop that calls it.
class Loop {
public:
    Loop(Robot & robot, const Parameters & parameters) : robot_(robot) {
        const auto options = rclcpp::NodeOptions().parameter_overrides(parameters);
        initialised = controller.init("controller", "", 200, "", options) == return_type::OK;
    }

    CallbackReturn configure() { return controller.on_configure({}); }

    CallbackReturn activate() {
        robot_.lend(controller);
        return controller.on_activate({});
    }

    /// Configures and activates, which must succeed.
    void start() {
        CHECK(initialised && configure() == CallbackReturn::SUCCESS && activate() == CallbackReturn::SUCCESS, "%s", said().c_str());
    }

    return_type update() {
        const std::int64_t period = static_cast<std::int64_t>(std::llround(1e9 * robot_.h));
        const auto result = controller.update(rclcpp::Time(time_), rclcpp::Duration(0, static_cast<std::uint32_t>(period)));
        time_ += period;
        return result;
    }

    /// The last line of the log.
    static std::string said() { return rclcpp::Log::lines().empty() ? "" : rclcpp::Log::lines().back(); }

    Controller controller;
    bool initialised;

private:
    Robot & robot_;
    // Clocks do not begin at 0.
    std::int64_t time_ = 1700000000000000000;
};

/// Numbers in the library's precision.
inline Vector narrow(const Numbers & x) {
    Vector y;
    for (std::size_t i = 0; i < N; i++) y[i] = static_cast<float>(x[i]);
    return y;
}

/// Efforts that the library gives, to the bit.
inline void same_bits(const Numbers & effort, const Vector & library) {
    for (std::size_t i = 0; i < N; i++) {
        CHECK(effort[i] == static_cast<double>(library[i]), "joint %zu: %.9g, library %.9g", i, effort[i], static_cast<double>(library[i]));
    }
}

/// The largest difference of two vectors.
inline double distance(const Numbers & a, const Numbers & b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < N; i++) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

}  // namespace test

#endif  // TEST__ROBOT_HPP_
