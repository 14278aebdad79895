// The controller's efforts are the library's, to the bit, and its modes do on the robot what they say.
#include <algorithm>

#include "robot.hpp"

namespace {

using namespace test;

const Numbers START{0.0, 0.4, -0.8, 0.0, 0.5, 0.0}, GOAL{0.6, 0.9, -0.4, 0.5, 0.9, -0.5};

/// The arm stays where it is put; without the controller it falls.
void gravity(const std::string & files) {
    Robot robot(files + "/arm.postcard", joints(), START), loose(files + "/arm.postcard", joints(), START);
    Loop loop(robot, parameters(files, "gravity"));
    loop.start();
    double moved = 0.0;
    for (int tick = 0; tick < 400; tick++) {
        CHECK(loop.update() == return_type::OK, "tick %d", tick);
        Vector u;
        robot.model().gravity_torque(narrow(robot.q), u);
        same_bits(robot.effort, u);
        robot.step();
        loose.step();
        moved = std::max(moved, distance(robot.q, START));
    }
    CHECK(moved < 1e-4 && distance(loose.q, START) > 0.5, "moved by %g, without control by %g", moved, distance(loose.q, START));
    loop.controller.on_deactivate({});
    CHECK(robot.effort == Numbers{}, "an effort after the end");
    std::printf("gravity: the arm stays within %.1e rad for 2 s; without control it falls by %.2f rad\n", moved, distance(loose.q, START));
}

/// A smooth motion about the start, at the time t.
leastaction_ros2::Reference reference(double t) {
    leastaction_ros2::Reference r;
    for (std::size_t i = 0; i < N; i++) {
        const double w = 2.0 + 0.4 * static_cast<double>(i), size = 0.3;
        r.q[i] = START[i] + size * (1.0 - std::cos(w * t));
        r.v[i] = size * w * std::sin(w * t);
        r.a[i] = size * w * w * std::cos(w * t);
    }
    return r;
}

void send(Controller & controller, const leastaction_ros2::Reference & r) {
    Controller::Point point;
    point.positions.assign(r.q.begin(), r.q.end());
    point.velocities.assign(r.v.begin(), r.v.end());
    point.accelerations.assign(r.a.begin(), r.a.end());
    CHECK(controller.get_node()->publish("~/reference", point), "no subscription");
}

Vector computed_torque(const Robot & robot, const leastaction_ros2::Reference & r) {
    Vector a, u;
    for (std::size_t i = 0; i < N; i++) {
        a[i] = static_cast<float>(r.a[i] + 400.0 * (r.q[i] - robot.q[i]) + 40.0 * (r.v[i] - robot.v[i]));
    }
    const Vector q = narrow(robot.q), v = narrow(robot.v);
    leastaction_inverse_dynamics(robot.model().get(), q.data(), v.data(), a.data(), N, u.data(), nullptr);
    return u;
}

/// The arm follows references, and holds the last position when they end.
void computed_torque(const std::string & files) {
    Robot robot(files + "/arm.postcard", joints(), START);
    Loop loop(robot, parameters(files, "computed_torque"));
    loop.start();
    // Before the first reference the position of the activation is held.
    leastaction_ros2::Reference now{START, {}, {}};
    double error = 0.0;
    for (int tick = 0; tick < 800; tick++) {
        if (tick >= 100) send(loop.controller, now = reference(robot.h * (tick - 100)));
        CHECK(loop.update() == return_type::OK, "tick %d", tick);
        same_bits(robot.effort, computed_torque(robot, now));
        error = std::max(error, distance(robot.q, now.q));
        robot.step();
    }
    // The first second catches up with nothing: references begin at rest.
    CHECK(error < 0.02, "off the motion by %g", error);
    CHECK(std::abs(now.v[0]) > 0.1, "the motion ends at rest, and shows nothing about the timeout");
    for (int tick = 0; tick < 400; tick++) {
        CHECK(loop.update() == return_type::OK, "tick %d", tick);
        robot.step();
    }
    CHECK(distance(robot.q, now.q) < 1e-3, "not held, but off by %g", distance(robot.q, now.q));
    std::printf("computed torque: off the motion by %.1e rad at most; held after its end within %.1e rad\n", error, distance(robot.q, now.q));
}

/// Efforts are cut at their limits, joint by joint.
void limits_hold(const std::string & files) {
    Robot robot(files + "/arm.postcard", joints(), START);
    Loop loop(robot, with(parameters(files, "computed_torque"), {"effort_limits", std::vector<double>(N, 1.5)}));
    loop.start();
    leastaction_ros2::Reference far{START, {}, {}};
    for (std::size_t i = 0; i < N; i++) far.q[i] += i % 2 == 0 ? 100.0 : -100.0;
    send(loop.controller, far);
    CHECK(loop.update() == return_type::OK, "%s", loop.said().c_str());
    const Vector u = computed_torque(robot, far);
    for (std::size_t i = 0; i < N; i++) {
        CHECK(robot.effort[i] == std::clamp(static_cast<double>(u[i]), -1.5, 1.5) && std::abs(robot.effort[i]) == 1.5, "joint %zu", i);
    }
    // References that are wrong are ignored, and the last one stands.
    const Numbers before = robot.effort;
    Controller::Point point;
    point.positions.assign(N - 1, 0.0);
    loop.controller.get_node()->publish("~/reference", point);
    CHECK(loop.said().find("ignored: it needs 6") != std::string::npos, "%s", loop.said().c_str());
    point.positions.assign(N, std::nan(""));
    loop.controller.get_node()->publish("~/reference", point);
    CHECK(loop.said().find("not finite") != std::string::npos, "%s", loop.said().c_str());
    CHECK(loop.update() == return_type::OK && robot.effort == before, "the reference changed");
}

/// The arm follows a plan to its goal, from beside its start and with an encoder that forgot a turn.
void follow(const std::string & files) {
    Numbers start = START;
    start[0] += 0.05;
    start[2] -= 0.05;
    Robot robot(files + "/arm.postcard", joints(), start);
    const leastaction_ros2::Plan plan(files + "/reach.postcard", robot.model());
    Loop loop(robot, with(parameters(files, "follow"), {"forgets_turns", std::vector<std::string>{"flange_turn"}}));
    robot.q[N - 1] += 2.0 * M_PI;
    loop.start();
    Vector turns{};
    for (int tick = 0; tick < 500; tick++) {
        if (tick > 0) robot.q[N - 1] += 2.0 * M_PI;
        Vector q = narrow(robot.q), u;
        if (tick == 0) plan.turns(q, {0, 0, 0, 0, 0, 1}, turns);
        for (std::size_t i = 0; i < N; i++) q[i] -= turns[i];
        CHECK(loop.update() == return_type::OK, "tick %d: %s", tick, loop.said().c_str());
        plan.command_at(static_cast<float>(robot.h * tick), q, narrow(robot.v), u);
        same_bits(robot.effort, u);
        robot.step();
    }
    CHECK(turns[N - 1] > 6.0f && distance(robot.q, GOAL) < 5e-3, "off the goal by %g", distance(robot.q, GOAL));
    std::printf("follow: from 0.05 rad beside the plan's start to within %.1e rad of its goal\n", distance(robot.q, GOAL));
    // Activated once more it begins anew, with the plan's first command for this state.
    loop.controller.on_deactivate({});
    CHECK(loop.activate() == CallbackReturn::SUCCESS && loop.update() == return_type::OK, "%s", loop.said().c_str());
    Vector u;
    plan.command_at(0.0f, narrow(robot.q), narrow(robot.v), u);
    same_bits(robot.effort, u);
}

}  // namespace

int main(int, char ** arguments) {
    const std::string files = arguments[1];
    gravity(files);
    computed_torque(files);
    limits_hold(files);
    follow(files);
}
