/// \file
/// Exceptions of inverse_dynamics_solver 2.0.3, with the names of upstream. Never installed.
#ifndef STATED__INVERSE_DYNAMICS_SOLVER__EXCEPTIONS_HPP_
#define STATED__INVERSE_DYNAMICS_SOLVER__EXCEPTIONS_HPP_

#include "../ros.hpp"

namespace inverse_dynamics_solver {

using InvalidParameterValueException = rclcpp::exceptions::InvalidParameterValueException;
using ParameterUninitializedException = rclcpp::exceptions::ParameterUninitializedException;
using UnimplementedError = rclcpp::exceptions::UnimplementedError;

class UninitializedException : public std::runtime_error {
public:
    UninitializedException() : std::runtime_error("Solver is not initialized") {}
};

}  // namespace inverse_dynamics_solver

#endif  // STATED__INVERSE_DYNAMICS_SOLVER__EXCEPTIONS_HPP_
