/* Following a plan: a loop of a fixed rate, with the library's own step as the machine. ../tools/src/bin/trace/follow.rs does the same in Rust. */
#include "example.h"

#define TICKS 80
#define TURN 6.2831855f

static leastaction_model model;
static leastaction_plan plan;
static leastaction_state machine;
static uint64_t hash = HASH;
static const float start[N] = {MODEL_Q};

static void add(const float *x) {
    hash = hashed(hash, x, N);
}

/* The encoder of coordinate 0 is a turn off, that of the last one two turns. */
static int measure(float *q, float *v) {
    leastaction_error error;
    float p[N];
    if (leastaction_state_q(&machine, N, q, &error) || leastaction_state_p(&machine, N, p, &error)
        || leastaction_state_w(&machine, N, v, &error)) {
        return refused("measure", &error);
    }
    add(q);
    add(p);
    add(v);
    q[0] -= TURN;
    q[N - 1] += 2 * TURN;
    return 0;
}

/* What the plan says about a tick, and about the time half a tick later, as a faster loop would ask. */
static int planned(uint32_t tick, float h) {
    leastaction_error error;
    float x[3][N], t = (float)tick * h;
    if (leastaction_plan_reference(&plan, tick, N, x[0], x[1], x[2], &error)) return refused("reference", &error);
    for (int i = 0; i < 3; i++) add(x[i]);
    if (leastaction_plan_reference_at(&plan, t + h / 2, N, x[0], x[1], x[2], &error)) return refused("reference", &error);
    for (int i = 0; i < 3; i++) add(x[i]);
    if (leastaction_plan_motion(&plan, t, N, x[0], x[1], x[2], &error)) return refused("motion", &error);
    for (int i = 0; i < 3; i++) add(x[i]);
    return 0;
}

/* ANCHOR: follow */
/* A tick of the loop: measure, and ask the plan for the command. Ticks count from the first command; missed ones count. */
static int decide(uint32_t tick, float *turns, float *q, float *v, float *u) {
    static const uint8_t forgets_turns[N] = {N > 1};
    leastaction_error error;
    if (measure(q, v)) return 1;
    if (tick == 0 && leastaction_plan_turns(&plan, q, forgets_turns, N, turns, &error)) return refused("turns", &error);
    for (int i = 0; i < N; i++) q[i] -= turns[i];
    if (leastaction_plan_command(&plan, tick, q, v, N, u, &error)) return refused("command", &error);
    return 0;
}
/* ANCHOR_END: follow */

/* Gives the command to the machine, whose model has no actuator: it is the force. */
static int step(uint32_t tick, float h, float *turns) {
    leastaction_error error;
    float q[N], v[N], u[N], later[N];
    if (decide(tick, turns, q, v, u)) return 1;
    add(turns);
    if (planned(tick, h)) return 1;
    add(u);
    if (leastaction_plan_command_at(&plan, (float)tick * h + h / 2, q, v, N, later, &error)) return refused("command", &error);
    add(later);
    if (leastaction_step4(&model, &machine, h, u, u, N, NULL, NULL, &error)) return refused("step", &error);
    return 0;
}

/* ANCHOR: load */
static int load(leastaction_plan_description *description) {
    leastaction_error error;
    size_t model_bytes = (size_t)(model_file_end - model_file), plan_bytes = (size_t)(plan_file_end - plan_file);
    if (leastaction_load(&model, sizeof model, LEASTACTION_ABI, model_file, model_bytes, MODEL_NAME, &error)
        || leastaction_plan_load(&plan, sizeof plan, LEASTACTION_ABI, plan_file, plan_bytes, &model, &error)
        || leastaction_plan_describe(&plan, description, &error)) {
        return refused("load", &error);
    }
    return 0;
}
/* ANCHOR_END: load */

int follow(void) {
    leastaction_error error;
    leastaction_plan_description description;
    float v[N], turns[N] = {0};
    for (int i = 0; i < N; i++) v[i] = (float)(i - 1) / 4;
    if (load(&description)) return 1;
    if (leastaction_start(&model, &machine, start, v, N, &error)) return refused("start", &error);
    for (uint32_t tick = 0; tick < TICKS; tick++) {
        if (step(tick, description.h, turns)) return 1;
    }
    put("follow ");
    put_number(hash, 16);
    put("\n");
    return 0;
}
