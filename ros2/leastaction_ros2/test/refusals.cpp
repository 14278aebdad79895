// Everything that a user can get wrong is refused with words that name it, and a state that is not a number stops the drives.
#include "robot.hpp"

namespace {

using namespace test;

const Numbers START{0.0, 0.4, -0.8, 0.0, 0.5, 0.0};

/// A parameter that is wrong leaves the controller unconfigured, and the log says why.
void refused(Robot & robot, const Parameters & parameters, const char * part) {
    rclcpp::Log::lines().clear();
    Loop loop(robot, parameters);
    CHECK(loop.initialised, "%s", part);
    CHECK(loop.configure() == CallbackReturn::FAILURE, "accepted: %s", part);
    CHECK(loop.said().find(part) != std::string::npos, "'%s' does not contain '%s'", loop.said().c_str(), part);
    CHECK(loop.controller.state_interface_configuration().names.empty(), "interfaces without a configuration");
    CHECK(loop.activate() == CallbackReturn::FAILURE, "activated without a configuration");
}

void parameters_refused(Robot & robot, const std::string & files) {
    const auto gravity = parameters(files, "gravity"), torque = parameters(files, "computed_torque"), plan = parameters(files, "follow");
    using Names = std::vector<std::string>;
    using Values = std::vector<double>;
    const double nan = std::nan("");
    refused(robot, {}, "parameter 'joints' has 0 values");
    refused(robot, with(gravity, {"mode", std::string("float")}), "gravity, computed_torque or follow");
    refused(robot, with(gravity, {"joints", Names{"a", "b"}}), "2 values, but leastaction_ros2 was built for 6");
    refused(robot, with(gravity, {"joints", Names(N, "a")}), "not unique");
    refused(robot, with(gravity, {"model", std::string()}), "parameter 'model' is missing");
    refused(robot, with(gravity, {"model", files + "/nowhere.postcard"}), "cannot be opened");
    refused(robot, with(gravity, {"model", files}), "'");
    refused(robot, with(gravity, {"model", files + "/damaged.postcard"}), "damaged");
    refused(robot, with(gravity, {"model", files + "/reach.postcard"}), "status 21");
    refused(robot, with(gravity, {"model", files + "/seven.postcard"}), "status 43");
    refused(robot, with(gravity, {"model", files + "/cartpole.postcard"}), "status 34");
    refused(robot, with(gravity, {"effort_limits", Values(N - 1, 1.0)}), "'effort_limits' has 5 values");
    refused(robot, with(gravity, {"effort_limits", Values(N, -1.0)}), "negative");
    refused(robot, with(gravity, {"effort_limits", Values(N, nan)}), "not finite");
    refused(robot, with(gravity, {"effort_limits", Values(N, 0.0)}), "0 for 'shoulder_turn'");
    refused(robot, with(torque, {"kp", Values{}}), "'kp' has 0 values");
    refused(robot, with(torque, {"kd", Values(N, -2.0)}), "'kd' has a number that is negative");
    refused(robot, with(torque, {"reference_timeout", 0.0}), "'reference_timeout' must be positive");
    refused(robot, with(plan, {"plan", std::string()}), "parameter 'plan' is missing");
    refused(robot, with(plan, {"plan", files + "/nowhere.postcard"}), "cannot be opened");
    refused(robot, with(plan, {"plan", files + "/damaged-plan.postcard"}), "the plan is damaged");
    refused(robot, with(plan, {"plan", files + "/swing-up.postcard"}), "status 9");
    refused(robot, with(plan, {"plan", files + "/other-plan.postcard"}), "status 93");
    refused(robot, with(plan, {"forgets_turns", Names{"wheel"}}), "'wheel', which is none of the joints");
    refused(robot, with(plan, {"effort_limits", Values(N, 3.0)}), "the plan may command 80");

    // A list of whole numbers is another type in ROS.
    CHECK(!Loop(robot, with(torque, {"kp", std::vector<std::int64_t>(N, 100)})).initialised, "whole numbers");
    CHECK(Loop::said().find("'kp' has invalid type") != std::string::npos, "%s", Loop::said().c_str());
}

/// A controller that was refused takes corrected parameters.
void corrected(Robot & robot, const std::string & files) {
    Loop loop(robot, with(parameters(files, "gravity"), {"model", files + "/damaged.postcard"}));
    CHECK(loop.configure() == CallbackReturn::FAILURE, "damaged");
    loop.controller.get_node()->set_parameter({"model", files + "/arm.postcard"});
    loop.start();
    loop.controller.on_deactivate({});
    loop.controller.release_interfaces();
    CHECK(loop.controller.on_cleanup({}) == CallbackReturn::SUCCESS, "cleanup");
    CHECK(loop.controller.command_interface_configuration().names.empty(), "interfaces after the cleanup");
    loop.start();
}

/// An interface that was not lent is missed at the activation.
void lent(Robot & robot, const std::string & files) {
    Loop loop(robot, parameters(files, "gravity"));
    CHECK(loop.configure() == CallbackReturn::SUCCESS, "%s", loop.said().c_str());
    CHECK(loop.controller.on_activate({}) == CallbackReturn::FAILURE, "activated without interfaces");
    CHECK(loop.said().find("'shoulder_turn' is missing") != std::string::npos, "%s", loop.said().c_str());
}

/// A state that is not usable stops the drives until the next activation, and is named.
void stopped(Robot & robot, const std::string & files, const char * mode, double & number, double value, const char * part) {
    const double good = number;
    Loop loop(robot, parameters(files, mode));
    loop.start();
    CHECK(loop.update() == return_type::OK && robot.effort != Numbers{}, "no effort before");
    number = value;
    CHECK(loop.update() == return_type::ERROR && robot.effort == Numbers{}, "%s: not stopped", part);
    number = good;
    CHECK(loop.update() == return_type::ERROR && robot.effort == Numbers{}, "%s: moved again by itself", part);
    loop.controller.on_deactivate({});
    CHECK(loop.said().find(part) != std::string::npos, "'%s' does not contain '%s'", loop.said().c_str(), part);
    number = value;
    CHECK(loop.activate() == CallbackReturn::FAILURE, "activated with %s", part);
    CHECK(loop.said().find(part) != std::string::npos, "'%s' does not contain '%s'", loop.said().c_str(), part);
    number = good;
    CHECK(loop.activate() == CallbackReturn::SUCCESS && loop.update() == return_type::OK, "%s: not activated again", part);
    CHECK(robot.effort != Numbers{}, "no effort after");
    loop.controller.on_deactivate({});
}

/// A command that cannot be computed, and interfaces that cannot be read or written.
void faults(Robot & robot, const std::string & files) {
    Loop loop(robot, parameters(files, "computed_torque"));
    loop.start();
    CHECK(loop.update() == return_type::OK, "%s", loop.said().c_str());
    Controller::Point point;
    point.positions.assign(N, 3e38);
    loop.controller.get_node()->publish("~/reference", point);
    CHECK(loop.update() == return_type::ERROR && robot.effort == Numbers{}, "a command that is none");
    loop.controller.on_deactivate({});
    CHECK(loop.said().find("stopped: ") != std::string::npos, "%s", loop.said().c_str());
    CHECK(loop.activate() == CallbackReturn::SUCCESS && loop.update() == return_type::OK, "%s", loop.said().c_str());
    robot.held = true;
    CHECK(loop.update() == return_type::ERROR, "interfaces that another thread holds");
    robot.held = false;
    CHECK(loop.update() == return_type::ERROR && robot.effort == Numbers{}, "not stopped");
}

}  // namespace

int main(int, char ** arguments) {
    const std::string files = arguments[1];
    Robot robot(files + "/arm.postcard", joints(), START);
    parameters_refused(robot, files);
    corrected(robot, files);
    lent(robot, files);
    for (const char * mode : {"gravity", "computed_torque", "follow"}) {
        for (const double value : {std::nan(""), HUGE_VAL, -1e300}) {
            stopped(robot, files, mode, robot.q[1], value, "position of joint 'shoulder_lift' is not a number");
            stopped(robot, files, mode, robot.v[4], value, "velocity of joint 'wrist_pitch' is not a number");
        }
    }
    faults(robot, files);
    std::puts("everything wrong was refused");
}
