// Pinocchio's side of arm_pinocchio.py: reads peer_arm's input and prints the same quantities. All work space is allocated beforehand.
#include "arm_model.hpp"
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/energy.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>

namespace pin = pinocchio;
using Vector = Eigen::VectorXd;

struct Vectors { Vector q, v, x; };

static Vector vector(const Numbers& x) { return Eigen::Map<const Vector>(x.data(), x.size()); }

static void print(const Vector& x) { print(x.data(), x.size()); }

// Prints the time with spatial vectors in the world's frame or in those of the bodies, whichever is less.
template <class Of> static void fastest(const char* name, const std::vector<Vectors>& states, Of of) {
    const auto with = [&](pin::Convention frames) { return nanoseconds(states, [&](const Vectors& s) { of(s, frames); }); };
    std::printf("%s %g\n", name, std::min(with(pin::Convention::WORLD), with(pin::Convention::LOCAL)));
}

int main() {
    const Input input = read_input();
    const pin::Model model = model_of(input);
    pin::Data data(model);
    std::vector<Vectors> states;
    for (const auto& [q, v, x] : input.states) states.push_back({vector(q), vector(v), vector(x)});
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
    clocked("inverse_dynamics", states, [&](const Vectors& s) { pin::rnea(model, data, s.q, s.v, s.x); });
    fastest("mass_matrix", states, [&](const Vectors& s, pin::Convention frames) { pin::crba(model, data, s.q, frames); });
    // The derivatives in the accelerations, M, come with them.
    clocked("derivatives", states, [&](const Vectors& s) { pin::computeRNEADerivatives(model, data, s.q, s.v, s.x); });
    fastest("acceleration", states, [&](const Vectors& s, pin::Convention frames) { pin::aba(model, data, s.q, s.v, s.x, frames); });
}
