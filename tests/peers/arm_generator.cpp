// Writes C for the arm of peer_arm's input: the functions that Pinocchio's generators record, and the same algorithms with spatial vectors in frames of the
// bodies. The argument is the folder.
#include "arm_model.hpp"
#include <pinocchio/codegen/cppadcg-algo.hpp>
#include <functional>

namespace pin = pinocchio;
using Base = pin::CodeGenBase<double>;

// A function of q, v and accelerations or forces.
struct Recorded : Base {
    using Of = std::function<void(const ADModel&, ADData&, const ADVectorXs&, ADVectorXs&)>;
    Recorded(const pin::Model& model, Eigen::Index inputs, Eigen::Index outputs, const std::string& name, Of of)
        : Base(model, inputs, outputs, name, name), of(std::move(of)) { build_jacobian = false; }
    void buildMap() override {
        CppAD::Independent(ad_X);
        of(ad_model, ad_data, ad_X, ad_Y);
        ad_fun.Dependent(ad_X, ad_Y);
        ad_fun.optimize("no_compare_op");
    }
    Of of;
};

// The Jacobian of a generator is written too, if asked for.
static void write(Base&& generator, const std::string& folder, bool jacobian = false) {
    generator.initLib();
    auto& source = generator.codeGenerator();
    source.setCreateJacobian(jacobian);
    CppAD::cg::ModelLibraryCSourceGen<double> library(source);
    CppAD::cg::SaveFilesModelLibraryProcessor<double>(library).saveSourcesTo(folder);
}

int main(int, char** arguments) {
    pin::Model model = model_of(read_input());
    // Products with sines of multiples of a right angle vanish.
    for (pin::SE3& placement : model.jointPlacements)
        placement.rotation() = placement.rotation().unaryExpr([](double x) { return std::abs(x) < 1e-15 ? 0.0 : x; });
    const std::string folder = arguments[1];
    const Eigen::Index n = model.nv;
    write(pin::CodeGenRNEA<double>(model, "rnea"), folder, true);
    write(pin::CodeGenCRBA<double>(model, "crba"), folder);
    write(pin::CodeGenABA<double>(model, "aba"), folder);
    write(pin::CodeGenRNEADerivatives<double>(model, "partial_rnea"), folder);
    write(Recorded(model, n, n * (n + 1) / 2, "crba_local", [](const auto& m, auto& data, const auto& x, auto& y) {
        pin::crba(m, data, x, pin::Convention::LOCAL);
        Eigen::Index at = 0;
        for (Eigen::Index i = 0; i < m.nv; ++i)
            for (Eigen::Index j = i; j < m.nv; ++j) y[at++] = data.M(i, j);
    }), folder);
    write(Recorded(model, 3 * n, n, "aba_local", [n](const auto& m, auto& data, const auto& x, auto& y) {
        y = pin::aba(m, data, x.head(n), x.segment(n, n), x.tail(n), pin::Convention::LOCAL);
    }), folder);
}
