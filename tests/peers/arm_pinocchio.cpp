// Pinocchio's side of arm_pinocchio.py: reads peer_arm's input and prints the same quantities. All work space is allocated beforehand.
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/energy.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <limits>
#include <vector>

namespace pin = pinocchio;
using Vector = Eigen::VectorXd;

struct State { Vector q, v, x; };

static double number() {
    double x = 0;
    if (!(std::cin >> x)) { std::fprintf(stderr, "the input ends too early\n"); std::exit(1); }
    return x;
}

static Eigen::Vector3d three() { const double x = number(), y = number(); return {x, y, number()}; }

template <class Of> static double nanoseconds(const std::vector<State>& states, Of of) {
    double best = std::numeric_limits<double>::infinity();
    for (int pass = 0; pass < 40; ++pass) {
        const auto started = std::chrono::steady_clock::now();
        for (const State& state : states) of(state);
        const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - started;
        best = std::min(best, spent.count() / states.size());
    }
    return best;
}

static void print(const Vector& x) { for (Eigen::Index i = 0; i < x.size(); ++i) std::printf("%.17g ", x[i]); }

int main() {
    const int n = static_cast<int>(number());
    std::vector<int> parents(n), slides(n);
    for (int k = 0; k < n; ++k) { parents[k] = static_cast<int>(number()); slides[k] = static_cast<int>(number()); }
    pin::Model model;
    model.gravity.linear(three());
    Vector rotors(n);
    for (int k = 0; k < n; ++k) {
        Eigen::Matrix3d rotation;
        for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = number();
        const Eigen::Vector3d place = three(), axis = three();
        Eigen::Matrix<double, 10, 1> inertia;
        for (int i = 0; i < 10; ++i) inertia[i] = number();
        rotors[k] = number();
        const pin::SE3 pose(rotation, place);
        const auto parent = static_cast<pin::JointIndex>(parents[k] + 1);
        const std::string name = "joint" + std::to_string(k);
        // Pinocchio has faster joints for axes of the frame.
        pin::JointModel joint;
        if (slides[k] == 1) joint = pin::JointModelPrismaticUnaligned(axis);
        else if (axis == Eigen::Vector3d::UnitZ()) joint = pin::JointModelRZ();
        else joint = pin::JointModelRevoluteUnaligned(axis);
        const auto id = model.addJoint(parent, joint, pose, name);
        model.appendBodyToJoint(id, pin::Inertia::FromDynamicParameters(inertia), pin::SE3::Identity());
    }
    model.armature = rotors;
    pin::Data data(model);
    std::vector<State> states(static_cast<std::size_t>(number()));
    for (State& state : states)
        for (Vector* of : {&state.q, &state.v, &state.x}) { of->resize(n); for (int i = 0; i < n; ++i) (*of)[i] = number(); }
    for (const auto& [q, v, x] : states) {
        pin::crba(model, data, q);
        data.M.triangularView<Eigen::StrictlyLower>() = data.M.transpose().triangularView<Eigen::StrictlyLower>();
        const Eigen::MatrixXd mass = data.M;
        // computeKineticEnergy counts the rotors of some joints only.
        std::printf("%.17g %.17g ", 0.5 * v.dot(mass * v), pin::computePotentialEnergy(model, data, q));
        print(pin::rnea(model, data, q, v, x));
        print(pin::computeGeneralizedGravity(model, data, q));
        print(Vector(Eigen::Map<const Vector>(mass.data(), mass.size())));
        print(pin::aba(model, data, q, v, x));
        pin::computeRNEADerivatives(model, data, q, v, x);
        for (const auto* of : {&data.dtau_dq, &data.dtau_dv}) {
            const Eigen::MatrixXd rows = of->transpose();
            print(Vector(Eigen::Map<const Vector>(rows.data(), rows.size())));
        }
        std::printf("\n");
    }
    std::printf("inverse_dynamics %g\n", nanoseconds(states, [&](const State& s) { pin::rnea(model, data, s.q, s.v, s.x); }));
    std::printf("mass_matrix %g\n", nanoseconds(states, [&](const State& s) { pin::crba(model, data, s.q); }));
    // The derivatives in the accelerations, M, come with them.
    std::printf("derivatives %g\n", nanoseconds(states, [&](const State& s) { pin::computeRNEADerivatives(model, data, s.q, s.v, s.x); }));
    std::printf("acceleration %g\n", nanoseconds(states, [&](const State& s) { pin::aba(model, data, s.q, s.v, s.x); }));
}
