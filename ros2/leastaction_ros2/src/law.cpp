#include "leastaction_ros2/law.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace leastaction_ros2 {

namespace {

Vector narrow(const Numbers & x) noexcept {
    Vector y;
    std::transform(x.begin(), x.end(), y.begin(), [](double x) { return static_cast<float>(x); });
    return y;
}

}  // namespace

Law::Law(const Settings & settings)
: settings_(settings), model_(settings.model, settings.model_name), drives_(model_.drives()) {
    if (settings.mode != Mode::follow) return;
    plan_ = std::make_unique<const Plan>(settings.plan, model_);
    check_plan();
}

void Law::check_plan() const {
    const Vector largest = plan_->largest_commands();
    for (std::size_t i = 0; i < N; i++) {
        if (static_cast<double>(largest[i]) <= settings_.effort_limits[i]) continue;
        throw std::runtime_error(
            "the plan may command " + std::to_string(largest[i]) + " at '" + settings_.joints[i] + "', whose parameter effort_limits is "
            + std::to_string(settings_.effort_limits[i]));
    }
}

leastaction_status Law::computed_torque(const State & now, const Reference & reference, Vector & force) const noexcept {
    Numbers a;
    for (std::size_t i = 0; i < N; i++) {
        a[i] = reference.a[i] + settings_.kp[i] * (reference.q[i] - now.q[i]) + settings_.kd[i] * (reference.v[i] - now.v[i]);
    }
    // M a + h in one pass.
    return model_.inverse_dynamics(narrow(now.q), narrow(now.v), narrow(a), force);
}

leastaction_status Law::follow(const State & now, Vector & u) noexcept {
    Vector q = narrow(now.q);
    if (!begun_) {
        const auto status = plan_->turns(q, settings_.forgets_turns, turns_);
        if (status != LEASTACTION_STATUS_OK) return status;
        start_ = now.time;
        begun_ = true;
    }
    for (std::size_t i = 0; i < N; i++) q[i] -= turns_[i];
    const double seconds = 1e-9 * static_cast<double>(now.time - start_);
    return plan_->command_at(static_cast<float>(seconds), q, narrow(now.v), u);
}

leastaction_status Law::command(const State & now, const Reference & reference, Numbers & effort) noexcept {
    Vector u{};
    leastaction_status status = LEASTACTION_STATUS_OK;
    switch (settings_.mode) {
        case Mode::gravity: status = model_.gravity_torque(narrow(now.q), u); break;
        case Mode::computed_torque: status = computed_torque(now, reference, u); break;
        case Mode::follow: status = follow(now, u); break;
    }
    if (status != LEASTACTION_STATUS_OK) return status;
    const bool forces = settings_.mode != Mode::follow;
    for (std::size_t i = 0; i < N; i++) {
        // Plans hold commands; the other laws give forces, which the drives make of commands.
        const float command = forces ? (u[i] - drives_.offset[i]) / drives_.gain[i] : u[i];
        const double limit = settings_.effort_limits[i];
        effort[i] = std::clamp(static_cast<double>(command), -limit, limit);
    }
    return status;
}

}  // namespace leastaction_ros2
