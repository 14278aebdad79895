// Runs the C that arm_generator.cpp wrote: reads peer_arm's input and prints the same quantities, except the energies. Of two functions for one quantity the
// states take turns, and the faster one's time is printed.
#include "arm_input.hpp"
#include <initializer_list>

struct Atomic { void* library; int (*forward)(); int (*reverse)(); };
using Generated = void(const double* const*, double* const*, Atomic);

extern "C" Generated rnea_forward_zero, rnea_jacobian, partial_rnea_forward_zero, crba_forward_zero, crba_local_forward_zero, aba_forward_zero,
    aba_local_forward_zero;

static void call(Generated* of, const Numbers& state, Numbers& out) {
    const double* from = state.data();
    double* to = out.data();
    of(&from, &to, Atomic{});
}

// A state is one vector: q, v, accelerations or forces.
static std::vector<Numbers> joined(const std::vector<State>& states) {
    std::vector<Numbers> all;
    for (const State& state : states) {
        Numbers one = state.q;
        one.insert(one.end(), state.v.begin(), state.v.end());
        one.insert(one.end(), state.x.begin(), state.x.end());
        all.push_back(one);
    }
    return all;
}

// M from its rows' entries on and right of the diagonal.
static void print_symmetric(const Numbers& upper, std::size_t n) {
    const auto entry = [&](std::size_t i, std::size_t j) { return upper[i * n - i * (i + 1) / 2 + j]; };
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) { const double x = entry(std::min(i, j), std::max(i, j)); print(&x, 1); }
}

int main() {
    const Input input = read_input();
    const std::size_t n = input.bodies.size();
    const std::vector<Numbers> states = joined(input.states);
    Numbers out(3 * n * n);
    bool odd = false;
    for (const Numbers& state : states) {
        call(rnea_forward_zero, state, out);
        print(out.data(), n);
        Numbers still = state;
        std::fill(still.begin() + n, still.end(), 0);
        call(rnea_forward_zero, still, out);
        print(out.data(), n);
        call(odd ? crba_local_forward_zero : crba_forward_zero, state, out);
        print_symmetric(out, n);
        call(odd ? aba_local_forward_zero : aba_forward_zero, state, out);
        print(out.data(), n);
        call(odd ? rnea_jacobian : partial_rnea_forward_zero, state, out);
        // The Jacobian has the rows of all three matrices side by side.
        for (std::size_t matrix = 0; matrix < 2; ++matrix)
            for (std::size_t i = 0; i < n; ++i) print(&out[odd ? (3 * i + matrix) * n : (matrix * n + i) * n], n);
        std::printf("\n");
        odd = !odd;
    }
    const auto fastest = [&](const char* name, std::initializer_list<Generated*> functions) {
        double best = std::numeric_limits<double>::max();
        for (Generated* of : functions) best = std::min(best, nanoseconds(states, [&](const Numbers& state) { call(of, state, out); }));
        std::printf("%s %g\n", name, best);
    };
    fastest("inverse_dynamics", {rnea_forward_zero});
    fastest("mass_matrix", {crba_forward_zero, crba_local_forward_zero});
    // The derivatives in the accelerations, M, come with them.
    fastest("derivatives", {partial_rnea_forward_zero, rnea_jacobian});
    fastest("acceleration", {aba_forward_zero, aba_local_forward_zero});
}
