#include "leastaction_ros2/solver.hpp"

#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <limits>
#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/parameter.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

namespace leastaction_ros2 {

namespace {

using Parameters = rclcpp::node_interfaces::NodeParametersInterface;
using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::ParameterUninitializedException;

rclcpp::Parameter parameter(const Parameters & parameters, const std::string & name) {
    rclcpp::Parameter found;
    if (!parameters.get_parameter(name, found)) throw ParameterUninitializedException(name);
    return found;
}

/// Numbers in the library's precision. `what` names them in errors.
Vector numbers(const Eigen::VectorXd & given, const char * what) {
    if (given.size() != static_cast<Eigen::Index>(N)) {
        throw std::runtime_error(
            std::string(what) + ": " + std::to_string(given.size()) + " numbers, but the model has " + std::to_string(N) + " joints");
    }
    Vector x;
    for (std::size_t i = 0; i < N; i++) {
        const double number = given[static_cast<Eigen::Index>(i)];
        if (!(std::abs(number) <= static_cast<double>(std::numeric_limits<float>::max()))) {
            throw std::runtime_error(std::string(what) + ": number " + std::to_string(i) + " is not finite");
        }
        x[i] = static_cast<float>(number);
    }
    return x;
}

void check(leastaction_status status) {
    if (status != LEASTACTION_STATUS_OK) throw std::runtime_error(leastaction_message(status));
}

Eigen::VectorXd wide(const Vector & x) {
    return Eigen::Map<const Eigen::Matrix<float, static_cast<int>(N), 1>>(x.data()).template cast<double>();
}

/// Inverse dynamics for v and for −v: their mean has no friction, half their difference is friction.
std::pair<Eigen::VectorXd, Eigen::VectorXd> both_ways(const Model & model, const Vector & q, const Vector & v, const Vector & a) {
    Vector back, forward_torque, back_torque;
    for (std::size_t i = 0; i < N; i++) back[i] = -v[i];
    check(model.inverse_dynamics(q, v, a, forward_torque));
    check(model.inverse_dynamics(q, back, a, back_torque));
    return {wide(forward_torque), wide(back_torque)};
}

Eigen::VectorXd without_friction(const Model & model, const Vector & q, const Vector & v, const Vector & a) {
    const auto [forward, back] = both_ways(model, q, v, a);
    return (forward + back) / 2.0;
}

}  // namespace

void Solver::initialize(Parameters::ConstSharedPtr parameters_interface, const std::string & param_namespace, const std::string &) {
    if (parameters_interface == nullptr) {
        throw InvalidParameterValueException("leastaction_ros2::Solver needs the parameters of a node: 'model' and 'joints'");
    }
    const Parameters & parameters = *parameters_interface;
    const std::string prefix = param_namespace.empty() ? "" : param_namespace + ".";
    const std::size_t joints = parameter(parameters, prefix + "joints").as_string_array().size();
    if (joints != N) {
        throw InvalidParameterValueException(
            "'" + prefix + "joints' has " + std::to_string(joints) + " names, but leastaction_ros2 was built for "
            + std::to_string(N) + " coordinates (LEASTACTION_COORDINATES)");
    }
    const std::string path = parameter(parameters, prefix + "model").as_string();
    rclcpp::Parameter name;
    const bool named = parameters.get_parameter(prefix + "model_name", name);
    try {
        model_ = std::make_unique<const Model>(path, named ? name.as_string() : "");
    } catch (const std::runtime_error & error) {
        throw InvalidParameterValueException("'" + prefix + "model': " + error.what());
    }
}

const Model & Solver::model() const {
    if (model_ == nullptr) throw inverse_dynamics_solver::UninitializedException();
    return *model_;
}

Eigen::MatrixXd Solver::getInertiaMatrix(const Eigen::VectorXd & joint_positions) const {
    Matrix mass;
    check(model().mass_matrix(numbers(joint_positions, "joint_positions"), mass));
    constexpr int n = static_cast<int>(N);
    return Eigen::Map<const Eigen::Matrix<float, n, n>>(mass.data()).template cast<double>();
}

Eigen::VectorXd Solver::getCoriolisVector(
    const Eigen::VectorXd & joint_positions, const Eigen::VectorXd & joint_velocities) const {
    const Vector q = numbers(joint_positions, "joint_positions"), v = numbers(joint_velocities, "joint_velocities");
    Vector gravity;
    check(model().gravity_torque(q, gravity));
    return without_friction(model(), q, v, Vector{}) - wide(gravity);
}

Eigen::VectorXd Solver::getGravityVector(const Eigen::VectorXd & joint_positions) const {
    Vector gravity;
    check(model().gravity_torque(numbers(joint_positions, "joint_positions"), gravity));
    return wide(gravity);
}

Eigen::VectorXd Solver::getFrictionVector(const Eigen::VectorXd & joint_velocities) const {
    const auto [forward, back] = both_ways(model(), Vector{}, numbers(joint_velocities, "joint_velocities"), Vector{});
    return (forward - back) / 2.0;
}

Eigen::VectorXd Solver::getTorques(
    const Eigen::VectorXd & joint_positions, const Eigen::VectorXd & joint_velocities,
    const Eigen::VectorXd & joint_accelerations) const {
    const Vector q = numbers(joint_positions, "joint_positions"), v = numbers(joint_velocities, "joint_velocities");
    return without_friction(model(), q, v, numbers(joint_accelerations, "joint_accelerations"));
}

}  // namespace leastaction_ros2

PLUGINLIB_EXPORT_CLASS(leastaction_ros2::Solver, inverse_dynamics_solver::InverseDynamicsSolver)
