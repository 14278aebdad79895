// The arm that peer_arm reads, as Pinocchio has it.
#pragma once
#include <pinocchio/multibody.hpp>
#include "arm_input.hpp"
#include <cmath>
#include <string>

// Where an axis is one of the frame's, Pinocchio has a faster joint. Entries of rotations that are 0 but for the rounding of a sine are 0 with
// `clean`.
inline pinocchio::Model model_of(const Input& input, bool clean) {
    namespace pin = pinocchio;
    pin::Model model;
    model.gravity.linear(Eigen::Map<const Eigen::Vector3d>(input.gravity.data()));
    Eigen::VectorXd rotors(input.bodies.size());
    for (std::size_t k = 0; k < input.bodies.size(); ++k) {
        const auto& [parent, slides, numbers] = input.bodies[k];
        Eigen::Matrix3d rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
        Eigen::Vector3d place(numbers.data() + 9);
        const Eigen::Vector3d axis(numbers.data() + 12);
        if (clean)
            for (double* x : {rotation.data(), place.data()})
                for (int i = 0; i < (x == place.data() ? 3 : 9); ++i)
                    if (std::abs(x[i]) < 1e-15) x[i] = 0;
        const Eigen::Matrix<double, 10, 1> inertia(numbers.data() + 15);
        rotors[k] = numbers[25];
        pin::JointModel joint;
        if (slides) joint = pin::JointModelPrismaticUnaligned(axis);
        else if (axis == Eigen::Vector3d::UnitZ()) joint = pin::JointModelRZ();
        else joint = pin::JointModelRevoluteUnaligned(axis);
        const auto id = model.addJoint(parent + 1, joint, pin::SE3(rotation, place), "joint" + std::to_string(k));
        model.appendBodyToJoint(id, pin::Inertia::FromDynamicParameters(inertia), pin::SE3::Identity());
    }
    model.armature = rotors;
    return model;
}
