// Pinocchio's side of arm_pinocchio.py: reads what peer_arm reads and prints the same. All work space is allocated before.
#include "arm_pinocchio.hpp"
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/energy.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>

namespace pin = pinocchio;
using Vector = Eigen::VectorXd;

struct At { Vector q, v, x; };

static void print(const Vector& x) { print(x.data(), x.size()); }

int main() {
    const Input input = read_input();
    const pin::Model model = model_of(input, false);
    pin::Data data(model);
    const auto vector = [](const Numbers& x) { return Vector(Eigen::Map<const Vector>(x.data(), x.size())); };
    std::vector<At> states;
    for (const State& s : input.states) states.push_back({vector(s.q), vector(s.v), vector(s.x)});
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
    clocked("inverse_dynamics", states, [&](const At& s) { pin::rnea(model, data, s.q, s.v, s.x); });
    clocked("mass_matrix", states, [&](const At& s) { pin::crba(model, data, s.q); });
    // The derivatives in the accelerations, M, come with them.
    clocked("derivatives", states, [&](const At& s) { pin::computeRNEADerivatives(model, data, s.q, s.v, s.x); });
    clocked("acceleration", states, [&](const At& s) { pin::aba(model, data, s.q, s.v, s.x); });
}
