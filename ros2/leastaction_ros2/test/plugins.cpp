// The installed plugins are found and loaded by pluginlib, as a controller manager does.
#include <controller_interface/controller_interface.hpp>
#include <cstdio>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <pluginlib/class_loader.hpp>

int main() {
    using Solver = inverse_dynamics_solver::InverseDynamicsSolver;
    using Controller = controller_interface::ControllerInterface;
    pluginlib::ClassLoader<Solver> solvers("inverse_dynamics_solver", "inverse_dynamics_solver::InverseDynamicsSolver");
    pluginlib::ClassLoader<Controller> controllers("controller_interface", "controller_interface::ControllerInterface");
    const auto solver = solvers.createSharedInstance("leastaction_ros2/Solver");
    const auto controller = controllers.createSharedInstance("leastaction_ros2/Controller");
    try {
        solver->initialize();
        return 1;
    } catch (const std::runtime_error & error) {
        std::printf("%s\n", error.what());
    }
    if (controller->init("controller", "", 200, "", rclcpp::NodeOptions()) != controller_interface::return_type::OK) return 1;
    std::puts("both plugins load");
}
