// The input of peer_arm: an arm, and states at which to evaluate it; and a clock.
#pragma once
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <vector>

using Numbers = std::vector<double>;

// A body: the frame of its joint, the axis, the ten inertial numbers in the order of Pinocchio, the rotor.
struct Body { int parent; bool slides; std::array<double, 26> numbers; };
struct State { Numbers q, v, x; };
struct Input { std::array<double, 3> gravity; std::vector<Body> bodies; std::vector<State> states; };

inline double number() {
    double x = 0;
    if (!(std::cin >> x)) { std::fprintf(stderr, "the input ends too early\n"); std::exit(1); }
    return x;
}

template <class Of> void fill(Of& numbers) { for (double& x : numbers) x = number(); }

inline Input read_input() {
    Input input;
    input.bodies.resize(static_cast<std::size_t>(number()));
    for (Body& body : input.bodies) { body.parent = static_cast<int>(number()); body.slides = number() == 1; }
    fill(input.gravity);
    for (Body& body : input.bodies) fill(body.numbers);
    input.states.resize(static_cast<std::size_t>(number()));
    for (State& state : input.states)
        for (Numbers* of : {&state.q, &state.v, &state.x}) { of->resize(input.bodies.size()); fill(*of); }
    return input;
}

inline void print(const double* x, std::size_t count) { for (std::size_t i = 0; i < count; ++i) std::printf("%.17g ", x[i]); }

// The time of a call, ns: the fastest pass over all states.
template <class States, class Of> double nanoseconds(const States& states, Of of) {
    double best = std::numeric_limits<double>::max();
    for (int pass = 0; pass < 40; ++pass) {
        const auto started = std::chrono::steady_clock::now();
        for (const auto& state : states) of(state);
        const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - started;
        best = std::min(best, spent.count() / states.size());
    }
    return best;
}

template <class States, class Of> void clocked(const char* name, const States& states, Of of) { std::printf("%s %g\n", name, nanoseconds(states, of)); }
