// The arm of peer_arm's input as a model of Pinocchio.
#pragma once
#include "arm_input.hpp"
#include <pinocchio/multibody.hpp>
#include <string>

inline pinocchio::Model model_of(const Input& input) {
    namespace pin = pinocchio;
    const auto three = [](const double* x) { return Eigen::Vector3d(x[0], x[1], x[2]); };
    const auto n = static_cast<Eigen::Index>(input.bodies.size());
    pin::Model model;
    model.name = "arm";
    model.gravity.linear(three(input.gravity.data()));
    Eigen::VectorXd rotors(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const auto& [parent, slides, numbers] = input.bodies[k];
        const double* x = numbers.data();
        const Eigen::Matrix3d rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(x);
        const Eigen::Vector3d axis = three(x + 12);
        const Eigen::Matrix<double, 10, 1> inertia = Eigen::Map<const Eigen::Matrix<double, 10, 1>>(x + 15);
        rotors[k] = x[25];
        // Pinocchio has faster joints for axes of the frame.
        pin::JointModel joint;
        if (slides) joint = pin::JointModelPrismaticUnaligned(axis);
        else if (axis == Eigen::Vector3d::UnitZ()) joint = pin::JointModelRZ();
        else joint = pin::JointModelRevoluteUnaligned(axis);
        const pin::SE3 pose(rotation, three(x + 9));
        const auto id = model.addJoint(static_cast<pin::JointIndex>(parent + 1), joint, pose, "joint" + std::to_string(k));
        model.appendBodyToJoint(id, pin::Inertia::FromDynamicParameters(inertia), pin::SE3::Identity());
    }
    model.armature = rotors;
    return model;
}
