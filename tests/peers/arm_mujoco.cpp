// MuJoCo's side of arm_pinocchio.py: the argument is the arm as MJCF; reads peer_arm's input and prints the same quantities, except the derivatives,
// which MuJoCo takes by differences. Only the stages that a quantity needs are called: those of mj_inverse and mj_forward without constraints,
// contacts, sensors, passive and actuator forces.
#include "arm_input.hpp"
#include <mujoco/mujoco.h>

int main(int, char** arguments) {
    const Input input = read_input();
    char error[1000] = "";
    mjModel* model = mj_loadXML(arguments[1], nullptr, error, sizeof error);
    if (model == nullptr) { std::fprintf(stderr, "%s\n", error); return 1; }
    mjData* data = mj_makeData(model);
    const int n = model->nv;
    Numbers tau(n), force(n), a(n), mass(static_cast<std::size_t>(n) * n);
    const auto place = [&](const Numbers& q) {
        mju_copy(data->qpos, q.data(), n);
        mj_kinematics(model, data);
        mj_comPos(model, data);
    };
    const auto inverse = [&](const Numbers& q, const Numbers& v, const Numbers& x) {
        place(q);
        mju_copy(data->qvel, v.data(), n);
        mju_copy(data->qacc, x.data(), n);
        mj_comVel(model, data);
        mj_rne(model, data, 1, tau.data());
        for (int i = 0; i < n; ++i) tau[i] += model->dof_armature[i] * x[i];
    };
    const auto inertia = [&](const Numbers& q) { place(q); mj_makeM(model, data); };
    const auto forward = [&](const State& state) {
        inertia(state.q);
        mj_factorM(model, data);
        mju_copy(data->qvel, state.v.data(), n);
        mj_comVel(model, data);
        mj_rne(model, data, 0, tau.data());
        for (int i = 0; i < n; ++i) force[i] = state.x[i] - tau[i];
        mj_solveM(model, data, a.data(), force.data(), 1);
    };
    const Numbers zero(n);
    for (const State& state : input.states) {
        inverse(state.q, state.v, state.x);
        inertia(state.q);
        mj_energyPos(model, data);
        mj_energyVel(model, data);
        std::printf("%.17g %.17g ", data->energy[1], data->energy[0]);
        print(tau.data(), n);
        inverse(state.q, zero, zero);
        print(tau.data(), n);
        mj_fullM(model, data, mass.data());
        print(mass.data(), mass.size());
        forward(state);
        print(a.data(), n);
        std::printf("\n");
    }
    clocked("inverse_dynamics", input.states, [&](const State& s) { inverse(s.q, s.v, s.x); });
    clocked("mass_matrix", input.states, [&](const State& s) { inertia(s.q); });
    clocked("acceleration", input.states, forward);
    // The call of a typical user.
    clocked("mj_inverse", input.states, [&](const State& s) {
        mju_copy(data->qpos, s.q.data(), n);
        mju_copy(data->qvel, s.v.data(), n);
        mju_copy(data->qacc, s.x.data(), n);
        mj_inverse(model, data);
    });
    mj_deleteData(data);
    mj_deleteModel(model);
}
