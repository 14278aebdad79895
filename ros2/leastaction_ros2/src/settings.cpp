#include "leastaction_ros2/settings.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace leastaction_ros2 {

namespace {

[[noreturn]] void refuse(const std::string & name, const std::string & reason) {
    throw std::runtime_error("parameter '" + name + "' " + reason);
}

std::string count(std::size_t found) {
    return "has " + std::to_string(found) + " values, but leastaction_ros2 was built for " + std::to_string(N)
           + " coordinates (LEASTACTION_COORDINATES)";
}

Mode mode(const std::string & name) {
    if (name == "gravity") return Mode::gravity;
    if (name == "computed_torque") return Mode::computed_torque;
    if (name == "follow") return Mode::follow;
    refuse("mode", "is '" + name + "': it must be gravity, computed_torque or follow");
}

std::vector<std::string> joints(const std::vector<std::string> & names) {
    if (names.size() != N) refuse("joints", count(names.size()));
    const std::set<std::string> different(names.begin(), names.end());
    if (different.size() != N || different.count("") != 0) refuse("joints", "has a name that is empty or not unique");
    return names;
}

/// A number for each joint, finite and at least 0.
std::array<double, N> numbers(const std::string & name, const std::vector<double> & values) {
    if (values.size() != N) refuse(name, count(values.size()));
    const auto good = [](double x) { return std::isfinite(x) && x >= 0.0; };
    if (!std::all_of(values.begin(), values.end(), good)) refuse(name, "has a number that is negative or not finite");
    std::array<double, N> x;
    std::copy(values.begin(), values.end(), x.begin());
    return x;
}

std::array<std::uint8_t, N> marks(const std::vector<std::string> & joints, const std::vector<std::string> & marked) {
    std::array<std::uint8_t, N> marks{};
    for (const auto & name : marked) {
        const auto found = std::find(joints.begin(), joints.end(), name);
        if (found == joints.end()) refuse("forgets_turns", "names '" + name + "', which is none of the joints");
        marks[static_cast<std::size_t>(found - joints.begin())] = 1;
    }
    return marks;
}

double timeout(double seconds) {
    if (!std::isfinite(seconds) || seconds <= 0.0) refuse("reference_timeout", "must be positive and finite");
    return seconds;
}

/// Checks that every joint has a drive, as laws need that command all of them.
void all_driven(const Settings & settings) {
    for (std::size_t i = 0; i < N; i++) {
        if (settings.effort_limits[i] > 0.0) continue;
        refuse("effort_limits", "is 0 for '" + settings.joints[i] + "', but only the mode follow can leave a joint without a drive");
    }
}

}  // namespace

Settings read_settings(const rclcpp_lifecycle::LifecycleNode & node) {
    const auto text = [&](const char * name) { return node.get_parameter(name).as_string(); };
    const auto list = [&](const char * name) { return node.get_parameter(name).as_double_array(); };
    Settings settings;
    settings.mode = mode(text("mode"));
    settings.joints = joints(node.get_parameter("joints").as_string_array());
    settings.model = text("model");
    if (settings.model.empty()) refuse("model", "is missing: the path of a model file, as `leastaction export` writes");
    settings.model_name = text("model_name");
    settings.effort_limits = numbers("effort_limits", list("effort_limits"));
    if (settings.mode != Mode::follow) all_driven(settings);
    if (settings.mode == Mode::computed_torque) {
        settings.kp = numbers("kp", list("kp"));
        settings.kd = numbers("kd", list("kd"));
        settings.reference_timeout = timeout(node.get_parameter("reference_timeout").as_double());
    }
    if (settings.mode == Mode::follow) {
        settings.plan = text("plan");
        if (settings.plan.empty()) refuse("plan", "is missing: the path of a plan, as `leastaction plan` writes");
        settings.forgets_turns = marks(settings.joints, node.get_parameter("forgets_turns").as_string_array());
    }
    return settings;
}

}  // namespace leastaction_ros2
