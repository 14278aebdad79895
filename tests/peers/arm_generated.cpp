// The C that arm_generate.cpp writes: reads what peer_arm reads and prints inverse dynamics, mass matrix, forward dynamics and derivatives.
#include "arm_input.hpp"

extern "C" {
int inverse_dynamics(const double**, double**, long long*, double*, int);
int mass_matrix(const double**, double**, long long*, double*, int);
int acceleration(const double**, double**, long long*, double*, int);
int derivatives(const double**, double**, long long*, double*, int);
int differentiated(const double**, double**, long long*, double*, int);
}

int main() {
    const Input input = read_input();
    const std::size_t n = input.bodies.size(), square = n * n;
    Numbers tau(n), a(n), mass(square), by_q(square), by_v(square), work(1 << 16);
    // CasADi's columns are rows here.
    const auto print_rows = [&](const Numbers& columns) {
        for (std::size_t i = 0; i < square; ++i) print(&columns[i % n * n + i / n], 1);
    };
    const auto call = [&](auto of, const State& s, auto... results) {
        const double* given[] = {s.q.data(), s.v.data(), s.x.data()};
        double* found[] = {results...};
        of(given, found, nullptr, work.data(), 0);
    };
    for (const State& s : input.states) {
        call(inverse_dynamics, s, tau.data());
        call(mass_matrix, s, mass.data());
        call(acceleration, s, a.data());
        print(tau.data(), n);
        print_rows(mass);
        print(a.data(), n);
        call(derivatives, s, by_q.data(), by_v.data(), mass.data());
        print_rows(by_q);
        print_rows(by_v);
        std::printf("\n");
    }
    clocked("inverse_dynamics", input.states, [&](const State& s) { call(inverse_dynamics, s, tau.data()); });
    clocked("mass_matrix", input.states, [&](const State& s) { call(mass_matrix, s, mass.data()); });
    clocked("derivatives", input.states, [&](const State& s) { call(derivatives, s, by_q.data(), by_v.data(), mass.data()); });
    clocked("differentiated", input.states, [&](const State& s) { call(differentiated, s, by_q.data(), by_v.data(), mass.data()); });
    clocked("acceleration", input.states, [&](const State& s) { call(acceleration, s, a.data()); });
}
