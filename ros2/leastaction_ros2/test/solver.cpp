// The solver's numbers are the library's, to the bit.
#include "leastaction_ros2/solver.hpp"

#include <inverse_dynamics_solver/exceptions.hpp>

#include "robot.hpp"

namespace {

using namespace test;
using leastaction_ros2::Solver;

/// A node with parameters of the solver under `prefix`.
std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node(const std::string & files, const std::string & prefix) {
    auto node = std::make_shared<rclcpp_lifecycle::LifecycleNode>("node", rclcpp::NodeOptions());
    node->set_parameter({prefix + "model", files + "/arm.postcard"});
    node->set_parameter({prefix + "joints", joints()});
    return node;
}

/// Numbers of a state: in single precision, as the library takes them, and different for each of `kind`.
Vector state(int kind, int number) {
    Vector x;
    for (std::size_t i = 0; i < N; i++) x[i] = static_cast<float>(std::sin(1.0 + 7.0 * kind + 1.3 * number + 2.1 * static_cast<double>(i)));
    return x;
}

Eigen::VectorXd wide(const Vector & x) {
    Eigen::VectorXd y(N);
    for (std::size_t i = 0; i < N; i++) y[static_cast<Eigen::Index>(i)] = static_cast<double>(x[i]);
    return y;
}

/// Torques of the library, friction included.
Eigen::VectorXd library_torques(const leastaction_ros2::Model & model, const Vector & q, const Vector & v, const Vector & a) {
    Vector u;
    CHECK(leastaction_inverse_dynamics(model.get(), q.data(), v.data(), a.data(), N, u.data(), nullptr) == LEASTACTION_STATUS_OK, "u");
    return wide(u);
}

void equal_to_library(const Solver & solver, const leastaction_ros2::Model & model, int number) {
    const Vector q = state(0, number), v = state(1, number), a = state(2, number), rest{};
    Vector back;
    for (std::size_t i = 0; i < N; i++) back[i] = -v[i];
    // The arm has friction, which torques of this interface leave out: it is odd in v.
    const Eigen::VectorXd forth = library_torques(model, q, v, a), other = library_torques(model, q, back, a);
    CHECK(solver.getTorques(wide(q), wide(v), wide(a)) == (forth + other) / 2.0, "state %d", number);
    // At rest no friction acts: torques are the library's as they are.
    CHECK(solver.getTorques(wide(q), wide(rest), wide(a)) == library_torques(model, q, rest, a), "state %d", number);
    CHECK(solver.getGravityVector(wide(q)) == library_torques(model, q, rest, rest), "state %d", number);
    leastaction_ros2::Matrix mass;
    leastaction_mass_matrix(model.get(), q.data(), N, mass.data(), nullptr);
    const Eigen::MatrixXd inertia = solver.getInertiaMatrix(wide(q));
    for (std::size_t i = 0; i < N * N; i++) {
        CHECK(inertia(static_cast<int>(i / N), static_cast<int>(i % N)) == static_cast<double>(mass[i]), "entry %zu", i);
    }
}

/// The interface's identities, to the rounding of single precision.
void parts_add_up(const Solver & solver, const leastaction_ros2::Model & model, int number) {
    const Vector q = state(0, number), v = state(1, number), a = state(2, number);
    const auto [inertia, coriolis, gravity] = solver.getDynamicParameters(wide(q), wide(v));
    const Eigen::VectorXd torques = solver.getTorques(wide(q), wide(v), wide(a)), friction = solver.getFrictionVector(wide(v));
    const double scale = torques.cwiseAbs().maxCoeff();
    const double parts = (inertia * wide(a) + coriolis + gravity - torques).cwiseAbs().maxCoeff();
    CHECK(parts < 1e-5 * scale, "parts differ by %g of %g", parts, scale);
    // The arm's friction depends on velocities alone.
    const double all = (torques + friction - library_torques(model, q, v, a)).cwiseAbs().maxCoeff();
    CHECK(all < 1e-5 * scale, "torques with friction differ by %g of %g", all, scale);
    CHECK(coriolis.cwiseAbs().maxCoeff() > 1e-2 && friction.minCoeff() < -0.3, "no Coriolis forces or friction");
}

/// The message of an exception of the kind that a call must throw.
template <typename Exception, typename Call>
std::string thrown(Call call) {
    try {
        call();
    } catch (const Exception & error) {
        return error.what();
    }
    CHECK(false, "nothing was thrown");
}

void contains(const std::string & text, const char * part) {
    CHECK(text.find(part) != std::string::npos, "'%s' does not contain '%s'", text.c_str(), part);
}

void refusals(const std::string & files) {
    using namespace inverse_dynamics_solver;
    Solver solver;
    Eigen::VectorXd rest = Eigen::VectorXd::Zero(N);
    contains(thrown<UninitializedException>([&] { solver.getGravityVector(rest); }), "not initialized");
    contains(thrown<InvalidParameterValueException>([&] { solver.initialize(); }), "parameters of a node");
    const auto given = node(files, "");
    contains(thrown<ParameterUninitializedException>([&] { solver.initialize(given, "solver"); }), "solver.joints");
    given->set_parameter({"model", files + "/nowhere.postcard"});
    contains(thrown<InvalidParameterValueException>([&] { solver.initialize(given); }), "cannot be opened");
    given->set_parameter({"model", files});
    contains(thrown<InvalidParameterValueException>([&] { solver.initialize(given); }), "'model'");
    given->set_parameter({"model", files + "/damaged.postcard"});
    contains(thrown<InvalidParameterValueException>([&] { solver.initialize(given); }), "status 23");
    given->set_parameter({"model", files + "/cartpole.postcard"});
    contains(thrown<InvalidParameterValueException>([&] { solver.initialize(given); }), "bodies");
    given->set_parameter({"model", files + "/seven.postcard"});
    contains(thrown<InvalidParameterValueException>([&] { solver.initialize(given); }), "status 43");
    given->set_parameter({"model", files + "/empty.postcard"});
    contains(thrown<InvalidParameterValueException>([&] { solver.initialize(given); }), "status 20");
    given->set_parameter({"joints", std::vector<std::string>{"one", "two"}});
    contains(thrown<InvalidParameterValueException>([&] { solver.initialize(given); }), "2 names");
    contains(thrown<UninitializedException>([&] { solver.getFrictionVector(rest); }), "not initialized");

    solver.initialize(node(files, "solver."), "solver");
    const Eigen::VectorXd few = Eigen::VectorXd::Zero(N - 1);
    contains(thrown<std::runtime_error>([&] { solver.getInertiaMatrix(few); }), "joint_positions: 5 numbers");
    contains(thrown<std::runtime_error>([&] { solver.getTorques(rest, few, rest); }), "joint_velocities");
    Eigen::VectorXd bad = rest;
    for (const double number : {std::nan(""), HUGE_VAL, 1e300}) {
        bad[2] = number;
        contains(thrown<std::runtime_error>([&] { solver.getTorques(rest, rest, bad); }), "joint_accelerations: number 2");
        contains(thrown<std::runtime_error>([&] { solver.getGravityVector(bad); }), "not finite");
    }
    // A refused file leaves the model that was there.
    const Eigen::VectorXd before = solver.getGravityVector(rest);
    thrown<InvalidParameterValueException>([&] { solver.initialize(given); });
    CHECK(solver.getGravityVector(rest) == before, "the model was lost");
}

}  // namespace

int main(int, char ** arguments) {
    const std::string files = arguments[1];
    Solver solver;
    solver.initialize(node(files, "dynamics."), "dynamics", "<robot/>");
    const leastaction_ros2::Model model(files + "/arm.postcard");
    for (int number = 0; number < 100; number++) {
        equal_to_library(solver, model, number);
        parts_add_up(solver, model, number);
    }
    refusals(files);
    std::puts("the solver has the library's bits");
}
