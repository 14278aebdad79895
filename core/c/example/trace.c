/* Use of the library in a firmware: load a model, evaluate it, step it. ../tools/src/bin/trace.rs does the same in Rust. */
#include "example.h"

#define STEPS 200

static leastaction_model model;
static leastaction_state state;
static uint64_t hash = HASH;
static const float q[N] = {MODEL_Q};

static void add(const float *x, size_t count) {
    hash = hashed(hash, x, count);
}

/* ANCHOR: evaluate */
static int evaluate(const float *v, const float *u) {
    leastaction_error error;
    float a[N], force[N], p[N], energies[2];
    if (leastaction_acceleration(&model, q, v, u, N, a, &error)
        || leastaction_inverse_dynamics(&model, q, v, a, N, force, &error)
        || leastaction_momentum(&model, q, v, N, p, &error)
        || leastaction_energies(&model, q, v, N, energies, &error)) {
        return refused("evaluate", &error);
    }
    add(a, N);
    add(force, N);
    add(p, N);
    add(energies, 2);
#ifndef LEASTACTION_RODS
    float mass[N * N], torque[N];
    if (leastaction_mass_matrix(&model, q, N, mass, &error) || leastaction_gravity_torque(&model, q, N, torque, &error)) {
        return refused("terms", &error);
    }
    add(mass, N * N);
    add(torque, N);
#endif
    return 0;
}
/* ANCHOR_END: evaluate */

/* ANCHOR: bounded */
/* A tick of a control loop takes the same time every time: two updates. */
static leastaction_newton bounded(void) {
    leastaction_newton newton = leastaction_default_newton();
    newton.max_iterations = 2;
    newton.stop = 0;
    return newton;
}
/* ANCHOR_END: bounded */

static int step(float h, int order, int k, const leastaction_newton *newton) {
    leastaction_error error;
    leastaction_report report;
    float at[N], p[N], w[N], u[N] = {k / 32 % 2 == 0 ? 0.25f : -0.25f};
    leastaction_status status = order == 2 ? leastaction_step2(&model, &state, h, u, u, N, newton, &report, &error)
                                           : leastaction_step4(&model, &state, h, u, u, N, newton, &report, &error);
    if (status || leastaction_state_q(&state, N, at, &error) || leastaction_state_p(&state, N, p, &error)
        || leastaction_state_w(&state, N, w, &error)) {
        return refused("step", &error);
    }
    add(at, N);
    add(p, N);
    add(w, N);
#ifdef LEASTACTION_RODS
    float lambda[LEASTACTION_RODS];
    if (leastaction_state_lambda(&state, LEASTACTION_RODS, lambda, &error)) return refused("rods", &error);
    add(lambda, LEASTACTION_RODS);
#endif
    add(&report.residual, 1);
    add(&(float){(float)report.iterations}, 1);
    return 0;
}

static int run(float h, int order, const leastaction_newton *newton) {
    int failed = 0;
    for (int k = 0; k < STEPS && !failed; k++) {
        failed = step(h, order, k, newton);
    }
    return failed;
}

/* Starts from a velocity and steps in bounded time; then starts from two positions and steps without bounds. */
static int both_starts(float h, int order, const float *v, const float *u) {
    const leastaction_newton newton = bounded();
    leastaction_error error;
    float q1[N];
    if (leastaction_start(&model, &state, q, v, N, &error)) return refused("start", &error);
    if (run(h, order, &newton)) return 1;
    leastaction_status status = leastaction_start(&model, &state, q, v, N, &error);
    if (!status) {
        status = order == 2 ? leastaction_step2(&model, &state, h, u, u, N, NULL, NULL, &error)
                            : leastaction_step4(&model, &state, h, u, u, N, NULL, NULL, &error);
    }
    if (!status) status = leastaction_state_q(&state, N, q1, &error);
    if (!status) {
        status = order == 2 ? leastaction_start_from_positions2(&model, &state, h, q, q1, u, u, N, &error)
                            : leastaction_start_from_positions4(&model, &state, h, q, q1, u, u, N, &error);
    }
    if (status) return refused("start from positions", &error);
    return run(h, order, NULL);
}

int trace(void) {
    leastaction_error error;
    float h, v[N], u[N] = {0};
    uint8_t order, control;
    for (int i = 0; i < N; i++) {
        v[i] = (float)(i - 1) / 4;
    }
    size_t bytes = (size_t)(model_file_end - model_file);
    if (leastaction_load(&model, sizeof model, LEASTACTION_ABI, model_file, bytes, MODEL_NAME, &error)
        || leastaction_trained_step(&model, &h, &order, &control, &error)
        || leastaction_check_step(&model, h, order, &error)) {
        return refused("load", &error);
    }
    h /= 8;
    if (evaluate(v, u) || both_starts(h, 2, v, u) || both_starts(h, 4, v, u)) return 1;
    put("trace ");
    put_number(hash, 16);
    put("\n");
    return 0;
}
