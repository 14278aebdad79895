/// \file
/// A learned model as a solver of the package `inverse_dynamics_solver`, whose interface is that of its version 2.0.3.
#ifndef LEASTACTION_ROS2__SOLVER_HPP_
#define LEASTACTION_ROS2__SOLVER_HPP_

#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <string>

#include "leastaction_ros2/dynamics.hpp"

namespace leastaction_ros2 {

/// Torques of a learned model: H(q) a + C(q, v) v + f(v) + g(q) = τ, N m or N, with the joints in the order of the model's coordinates.
///
/// Numbers are those of the library in single precision. The functions are const, and may be called from several threads. Each throws
/// UninitializedException before initialize, and std::runtime_error if a vector has a wrong length or a number that is not finite.
class Solver : public inverse_dynamics_solver::InverseDynamicsSolver {
public:
    /// Loads the model. Parameters, in `param_namespace` if it is not empty:
    /// - `model`: path of the model file;
    /// - `joints`: names of the joints, in the order of the model's coordinates, whose number must be the model's;
    /// - `model_name`: the tree or graph to take, if the file holds several.
    ///
    /// The robot's description is not used: the model takes its place. Throws ParameterUninitializedException for a parameter that is
    /// missing, InvalidParameterValueException for another number of joints and for a file that cannot be read or is refused; a solver that
    /// was initialised before then keeps its model.
    void initialize(
        rclcpp::node_interfaces::NodeParametersInterface::ConstSharedPtr parameters_interface = nullptr,
        const std::string & param_namespace = "", const std::string & robot_description = "") override;

    /// H(q), kg m², kg m or kg.
    Eigen::MatrixXd getInertiaMatrix(const Eigen::VectorXd & joint_positions) const override;

    /// C(q, v) v: the part of the torques at no acceleration that is even in v, without gravity.
    Eigen::VectorXd getCoriolisVector(
        const Eigen::VectorXd & joint_positions, const Eigen::VectorXd & joint_velocities) const override;

    /// g(q), which also holds the robot against its springs.
    Eigen::VectorXd getGravityVector(const Eigen::VectorXd & joint_positions) const override;

    /// f(v): the part of the torques that is odd in v. The interface gives no positions: friction that depends on them or on the load of a
    /// joint is taken at positions 0.
    Eigen::VectorXd getFrictionVector(const Eigen::VectorXd & joint_velocities) const override;

    /// H(q) a + C(q, v) v + g(q), without friction, as the interface says, by one pass of inverse dynamics each for v and −v.
    Eigen::VectorXd getTorques(
        const Eigen::VectorXd & joint_positions, const Eigen::VectorXd & joint_velocities,
        const Eigen::VectorXd & joint_accelerations) const override;

private:
    const Model & model() const;

    std::unique_ptr<const Model> model_;
};

}  // namespace leastaction_ros2

#endif  // LEASTACTION_ROS2__SOLVER_HPP_
