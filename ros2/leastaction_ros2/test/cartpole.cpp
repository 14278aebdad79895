// A machine with a joint that nothing drives, and a drive with gain and delay: the learned cart-pole and its swing-up.
#include "robot.hpp"

namespace {

using namespace test;

const std::vector<std::string> JOINTS{"cart", "pole"};

Parameters cartpole(const std::string & files, const std::string & mode, double pole) {
    return {
        {"mode", mode},
        {"joints", JOINTS},
        {"model", files + "/cartpole.postcard"},
        {"plan", files + "/swing-up.postcard"},
        {"effort_limits", std::vector<double>{12.0, pole}},
        {"kp", std::vector<double>(N, 100.0)},
        {"kd", std::vector<double>(N, 20.0)},
    };
}

/// The pole comes up, and stays up, by the cart's drive alone.
void swing_up(const std::string & files) {
    Robot robot(files + "/cartpole.postcard", JOINTS, {0.02, M_PI - 0.05}, 0.01);
    const leastaction_ros2::Plan plan(files + "/swing-up.postcard", robot.model());
    Loop loop(robot, cartpole(files, "follow", 0.0));
    loop.start();
    const auto driven = loop.controller.command_interface_configuration().names;
    CHECK(driven == std::vector<std::string>{"cart/effort"}, "%zu command interfaces", driven.size());
    CHECK(loop.controller.state_interface_configuration().names.size() == 4, "state interfaces");
    for (int tick = 0; tick < 600; tick++) {
        Vector u;
        CHECK(loop.update() == return_type::OK, "%s", loop.said().c_str());
        plan.command_at(static_cast<float>(robot.h * tick), narrow(robot.q), narrow(robot.v), u);
        same_bits(robot.effort, u);
        robot.step();
    }
    // Upright is upright after any number of turns.
    const double off = distance({robot.q[0], std::remainder(robot.q[1], 2.0 * M_PI)}, {});
    CHECK(off < 0.05, "not upright, but off by %g", off);
    std::printf("cart-pole: upright by one drive within %.1e (m, rad)\n", off);
}

/// Commands of the other laws are such that the drive, with its gain, makes the law's force.
void drive(const std::string & files) {
    Robot robot(files + "/cartpole.postcard", JOINTS, {0.1, 0.5}, 0.01);
    Loop loop(robot, cartpole(files, "computed_torque", 12.0));
    loop.start();
    Controller::Point point;
    point.positions = {0.12, 0.5};
    CHECK(loop.controller.get_node()->publish("~/reference", point), "no subscription");
    CHECK(loop.update() == return_type::OK, "%s", loop.said().c_str());
    const Vector q = narrow(robot.q), v{}, a{static_cast<float>(100.0 * (0.12 - robot.q[0])), 0.0f}, effort = narrow(robot.effort);
    Vector force, u0, u1;
    CHECK(robot.model().inverse_dynamics(q, v, a, force) == LEASTACTION_STATUS_OK, "force");
    leastaction_actuate(robot.model().get(), 0.01f, effort.data(), effort.data(), N, u0.data(), u1.data(), nullptr);
    for (std::size_t i = 0; i < N; i++) {
        CHECK(std::abs(u0[i] - force[i]) < 1e-6f && std::abs(u1[i] - force[i]) < 1e-6f, "joint %zu: %g", i, static_cast<double>(u0[i]));
    }
    CHECK(std::abs(effort[0] - force[0]) > 0.05f, "the drive has no gain, or there is no force: %g", static_cast<double>(force[0]));
}

/// Laws that need every drive say which one is missing.
void missing_drive(const std::string & files) {
    Robot robot(files + "/cartpole.postcard", JOINTS, {});
    for (const char * mode : {"gravity", "computed_torque"}) {
        Loop loop(robot, cartpole(files, mode, 0.0));
        CHECK(loop.configure() == CallbackReturn::FAILURE, "%s", mode);
        CHECK(loop.said().find("0 for 'pole'") != std::string::npos, "%s", loop.said().c_str());
    }
}

}  // namespace

int main(int, char ** arguments) {
    const std::string files = arguments[1];
    swing_up(files);
    drive(files);
    missing_drive(files);
}
