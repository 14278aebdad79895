// Pinocchio's algorithms over CasADi's symbols, as C: the argument is the file to write. Reads what peer_arm reads.
#include <pinocchio/autodiff/casadi.hpp>
#include "arm_pinocchio.hpp"
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>

namespace pin = pinocchio;
using casadi::SX;
using Symbols = Eigen::Matrix<SX, Eigen::Dynamic, 1>;

static Symbols symbols(const SX& x) {
    Symbols of(x.size1());
    for (Eigen::Index i = 0; i < of.size(); ++i) of[i] = x(i);
    return of;
}

template <class Matrix> static SX expression(const Matrix& x) {
    SX of(x.rows(), x.cols());
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        for (Eigen::Index j = 0; j < x.cols(); ++j) of(i, j) = x(i, j);
    return SX::densify(of);
}

int main(int, char** arguments) {
    const Input input = read_input();
    const auto model = model_of(input, true).cast<SX>();
    const auto n = static_cast<casadi_int>(input.bodies.size());
    const SX q = SX::sym("q", n), v = SX::sym("v", n), x = SX::sym("x", n);
    const Symbols at = symbols(q), rate = symbols(v), last = symbols(x);
    const std::string file = arguments[1];
    casadi::CodeGenerator code(file.substr(file.rfind('/') + 1));
    const auto add = [&](const std::string& name, std::vector<SX> results) {
        code.add(casadi::Function(name, {q, v, x}, cse(results)));
    };
    pin::DataTpl<SX> data(model);
    const SX tau = expression(pin::rnea(model, data, at, rate, last));
    add("inverse_dynamics", {tau});
    pin::crba(model, data, at);
    data.M.triangularView<Eigen::StrictlyLower>() = data.M.transpose().triangularView<Eigen::StrictlyLower>();
    const SX mass = expression(data.M);
    add("mass_matrix", {mass});
    add("acceleration", {expression(pin::aba(model, data, at, rate, last))});
    pin::DataTpl<SX> fresh(model);
    pin::computeRNEADerivatives(model, fresh, at, rate, last);
    fresh.M.triangularView<Eigen::StrictlyLower>() = fresh.M.transpose().triangularView<Eigen::StrictlyLower>();
    add("derivatives", {expression(fresh.dtau_dq), expression(fresh.dtau_dv), expression(fresh.M)});
    // The same by CasADi's differentiation of inverse dynamics.
    add("differentiated", {SX::densify(jacobian(tau, q)), SX::densify(jacobian(tau, v)), mass});
    code.generate(file.substr(0, file.rfind('/') + 1));
}
