/* Checks that every error has its own status, causes no fault and changes nothing. */
#include "expect.h"
#include <math.h>
#include <string.h>

#define FILE_MOST 4096

static leastaction_model model, other;
static leastaction_state state, before;
static _Alignas(4) uint8_t file[FILE_MOST + 4];
static size_t bytes;
static const float zero[N];
static const float q[N] = {MODEL_Q};

static leastaction_status load(size_t length) {
    return leastaction_load(&model, sizeof model, LEASTACTION_ABI, file, length, MODEL_NAME, &error);
}

static leastaction_status of_byte(size_t position) {
    if (position < 4) return LEASTACTION_STATUS_NOT_A_MODEL;
    return position == 4 ? LEASTACTION_STATUS_VERSION : LEASTACTION_STATUS_CHECKSUM;
}

static void damaged(void) {
    for (size_t i = 0; i < bytes; i++) {
        file[i] ^= (uint8_t)(1u << i % 8);
        expect(__FILE__, __LINE__, load(bytes), of_byte(i));
        file[i] ^= (uint8_t)(1u << i % 8);
    }
    for (size_t length = 0; length < bytes; length++) {
        leastaction_status found = load(length);
        REQUIRE(found == LEASTACTION_STATUS_TOO_SHORT || found == LEASTACTION_STATUS_CHECKSUM);
    }
    file[4] = 99;
    EXPECT(VERSION, load(bytes));
    REQUIRE(error.numbers[0] == 99);
    file[4] = 1;
    EXPECT(VERSION, load(bytes));
    REQUIRE(error.numbers[0] == 1);
    file[4] = 2;
    EXPECT(NOT_LOADED, leastaction_acceleration(&model, zero, zero, zero, N, (float[N]){0}, &error));
    EXPECT(OK, load(bytes));
}

static void misplaced(void) {
    float x[N];
    memmove(file + 1, file, bytes);
    EXPECT(UNALIGNED, leastaction_load(&other, sizeof other, LEASTACTION_ABI, file + 1, bytes, MODEL_NAME, &error));
    REQUIRE(error.numbers[0] != 0);
    memmove(file, file + 1, bytes);
    EXPECT(NULL_POINTER, leastaction_load(NULL, sizeof other, LEASTACTION_ABI, file, bytes, MODEL_NAME, &error));
    EXPECT(NULL_POINTER, leastaction_load(&other, sizeof other, LEASTACTION_ABI, NULL, bytes, MODEL_NAME, &error));
    REQUIRE(error.numbers[0] == 4);
    EXPECT(OTHER_ABI, leastaction_load(&other, sizeof other, 1, file, bytes, MODEL_NAME, &error));
    REQUIRE(error.numbers[0] == LEASTACTION_ABI && error.numbers[1] == 1);
    EXPECT(WRONG_LENGTH, leastaction_load(&other, sizeof other + 4, LEASTACTION_ABI, file, bytes, MODEL_NAME, &error));
    EXPECT(WRONG_LENGTH, leastaction_load(&other, sizeof other, LEASTACTION_ABI, file, SIZE_MAX, MODEL_NAME, &error));
    void *odd = (uint8_t *)&other + 1;
    EXPECT(MISALIGNED, leastaction_load(odd, sizeof other, LEASTACTION_ABI, file, bytes, MODEL_NAME, &error));
    EXPECT(NOT_LOADED, leastaction_momentum(&other, zero, zero, N, x, &error));
    EXPECT(OK, load(bytes));
    other = model;
    EXPECT(NOT_LOADED, leastaction_momentum(&other, zero, zero, N, x, &error));
#if defined LEASTACTION_MODULAR || defined LEASTACTION_GRAPH
    EXPECT(NULL_POINTER, leastaction_load(&other, sizeof other, LEASTACTION_ABI, file, bytes, NULL, &error));
    leastaction_status none = leastaction_load(&other, sizeof other, LEASTACTION_ABI, file, bytes, "nothing", &error);
    REQUIRE(none == LEASTACTION_STATUS_NO_SUCH_TREE || none == LEASTACTION_STATUS_NO_SUCH_GRAPH);
    EXPECT(BAD_NAME, leastaction_load(&other, sizeof other, LEASTACTION_ABI, file, bytes, "\xff", &error));
    static const char endless[] = "0123456789012345678901234567890123456789012345678901234567890123456789";
    EXPECT(BAD_NAME, leastaction_load(&other, sizeof other, LEASTACTION_ABI, file, bytes, endless, &error));
#endif
#if defined LEASTACTION_GRAPH && !defined LEASTACTION_RODS
    EXPECT(RODS, leastaction_load(&other, sizeof other, LEASTACTION_ABI, file, bytes, "ring", &error));
    REQUIRE(error.numbers[0] == 2);
#endif
}

static void arguments(void) {
    float x[N];
    const float nan[N] = {NAN};
    const float *odd = (const float *)((const uint8_t *)zero + 1);
    EXPECT(NULL_POINTER, leastaction_acceleration(NULL, zero, zero, zero, N, x, &error));
    REQUIRE(error.numbers[0] == 1);
    EXPECT(NULL_POINTER, leastaction_acceleration(&model, NULL, zero, zero, N, x, &error));
    EXPECT(NULL_POINTER, leastaction_acceleration(&model, zero, NULL, zero, N, x, &error));
    EXPECT(NULL_POINTER, leastaction_acceleration(&model, zero, zero, NULL, N, x, &error));
    REQUIRE(error.numbers[0] == 4);
    EXPECT(NULL_POINTER, leastaction_acceleration(&model, zero, zero, zero, N, NULL, &error));
    REQUIRE(error.numbers[0] == 6);
    EXPECT(MISALIGNED, leastaction_acceleration(&model, zero, odd, zero, N, x, &error));
    REQUIRE(error.numbers[0] == 3);
    EXPECT(WRONG_LENGTH, leastaction_acceleration(&model, zero, zero, zero, N + 1, x, &error));
    REQUIRE(error.numbers[0] == N && error.numbers[1] == N + 1);
    EXPECT(NOT_FINITE, leastaction_acceleration(&model, nan, zero, zero, N, x, &error));
    EXPECT(NOT_FINITE, leastaction_inverse_dynamics(&model, nan, zero, zero, N, x, &error));
    EXPECT(NOT_FINITE, leastaction_momentum(&model, zero, nan, N, x, &error));
    EXPECT(NOT_FINITE, leastaction_energies(&model, nan, zero, N, x, &error));
#ifndef LEASTACTION_RODS
    float mass[N * N];
    EXPECT(NOT_FINITE, leastaction_mass_matrix(&model, nan, N, mass, &error));
    EXPECT(WRONG_LENGTH, leastaction_mass_matrix(&model, zero, N * N, mass, &error));
    EXPECT(NULL_POINTER, leastaction_mass_matrix(&model, zero, N, NULL, &error));
    REQUIRE(error.numbers[0] == 4);
    EXPECT(NULL_POINTER, leastaction_gravity_torque(&model, NULL, N, x, &error));
    EXPECT(NOT_FINITE, leastaction_gravity_torque(&model, nan, N, x, &error));
#endif
    EXPECT(NULL_POINTER, leastaction_energies(&model, zero, zero, N, NULL, &error));
    EXPECT(NULL_POINTER, leastaction_trained_step(&model, NULL, NULL, NULL, &error));
    leastaction_error *misplaced = (leastaction_error *)((uint8_t *)&error + 1);
    REQUIRE(leastaction_momentum(&model, zero, zero, N, x, misplaced) == LEASTACTION_STATUS_MISALIGNED);
}

/* Facts of the file: order 4, 0.05 s, held; no actuator, no range. */
static void said(void) {
    float h, u0[N], u1[N], u[N] = {0.5f}, nan[N] = {NAN};
    uint8_t order, control;
    uint16_t late = 9;
    leastaction_outside outside;
    EXPECT(OK, leastaction_trained_step(&model, &h, &order, &control, &error));
    REQUIRE(h == 0.05f && order == 4 && control == 0);
    EXPECT(OK, leastaction_check_step(&model, h, 4, &error));
    EXPECT(OTHER_STEP, leastaction_check_step(&model, h / 2, 4, &error));
    EXPECT(OTHER_STEP, leastaction_check_step(&model, NAN, 4, &error));
    EXPECT(ORDER, leastaction_check_step(&model, h, 2, &error));
    REQUIRE(error.numbers[0] == 4 && error.numbers[1] == 2);
    EXPECT(ORDER, leastaction_check_step(&model, h, 3, &error));
    EXPECT(OK, leastaction_late_steps(&model, h, &late, &error));
    REQUIRE(late == 0);
    EXPECT(OK, leastaction_actuate(&model, h, zero, u, N, u0, u1, &error));
    REQUIRE(u0[0] == 0.5f && u1[0] == 0.5f && u0[1] == 0);
    EXPECT(BAD_STEP, leastaction_actuate(&model, 0, zero, u, N, u0, u1, &error));
    EXPECT(NOT_FINITE, leastaction_actuate(&model, h, zero, nan, N, u0, u1, &error));
    EXPECT(NO_RANGE, leastaction_check_range(&model, zero, zero, zero, N, &outside, &error));
    EXPECT(NULL_POINTER, leastaction_check_range(&model, zero, zero, zero, N, NULL, &error));
    REQUIRE(leastaction_abi() == LEASTACTION_ABI && leastaction_version()[1] == '.');
}

#ifdef WHOLE_FILE
/* A cart-pole whose file has every section: a delay of 0.125 s, and a range. */
extern const uint8_t whole_file[], whole_file_end[];

static void whole(void) {
    float u0[N], u1[N], one[N] = {1, 1}, far[N] = {2.5f, 0}, turned[N] = {0, 12.566371f}, nan[N] = {NAN};
    uint16_t late = 0;
    leastaction_outside outside;
    size_t length = (size_t)(whole_file_end - whole_file);
    EXPECT(OK, leastaction_load(&other, sizeof other, LEASTACTION_ABI, whole_file, length, MODEL_NAME, &error));
    EXPECT(OK, leastaction_late_steps(&other, 0.05f, &late, &error));
    REQUIRE(late == 2);
    EXPECT(OUT_OF_RANGE, leastaction_late_steps(&other, 1e-9f, &late, &error));
    EXPECT(OK, leastaction_actuate(&other, 0.0625f, zero, one, N, u0, u1, &error));
    /* Two whole steps late, and no rest: g u + o. */
    REQUIRE(u0[0] == 1.5f && u1[0] == 1.5f && u0[1] == 0.25f && u1[1] == 0.25f);
    EXPECT(OK, leastaction_actuate(&other, 0.25f, zero, one, N, u0, u1, &error));
    /* A jump of 2 in the middle of the step: mean 0.5, slope 3. */
    REQUIRE(u0[0] == -1 && u1[0] == 2);
    EXPECT(OK, leastaction_check_range(&other, zero, zero, zero, N, &outside, &error));
    REQUIRE(outside.quantity == 0 && outside.coordinate == 0);
    EXPECT(OK, leastaction_check_range(&other, turned, zero, zero, N, &outside, &error));
    REQUIRE(outside.quantity == 0);
    EXPECT(OK, leastaction_check_range(&other, far, zero, zero, N, &outside, &error));
    REQUIRE(outside.quantity == 'q' && outside.coordinate == 0);
    EXPECT(OK, leastaction_check_range(&other, zero, zero, one, N, &outside, &error));
    REQUIRE(outside.quantity == 'u' && outside.coordinate == 1);
    EXPECT(OK, leastaction_check_range(&other, zero, nan, zero, N, &outside, &error));
    REQUIRE(outside.quantity == 'v' && outside.coordinate == 0);
}
#endif

static void starts(void) {
    const float h = 0.01f, nan[N] = {NAN};
    const leastaction_state none = {0};
    float x[N];
    before = none;
    EXPECT(NOT_STARTED, leastaction_step2(&model, &before, h, zero, zero, N, NULL, NULL, &error));
    EXPECT(NOT_STARTED, leastaction_state_q(&before, N, x, &error));
    EXPECT(NOT_FINITE, leastaction_start(&model, &before, nan, zero, N, &error));
    EXPECT(NOT_STARTED, leastaction_state_p(&before, N, x, &error));
    EXPECT(OK, leastaction_start(&model, &state, q, zero, N, &error));
    EXPECT(OK, leastaction_step4(&model, &state, h, zero, zero, N, NULL, NULL, &error));
}

static void refused_bounds(void) {
    const leastaction_newton right = leastaction_default_newton();
    leastaction_newton wrong[3] = {right, right, right};
    wrong[0].max_iterations = 0;
    wrong[1].stop = -1;
    wrong[2].accept = NAN;
    before = state;
    for (unsigned i = 0; i < 3; i++) {
        EXPECT(BAD_NEWTON, leastaction_step2(&model, &state, 0.01f, zero, zero, N, &wrong[i], NULL, &error));
        REQUIRE(error.numbers[0] == i + 1);
    }
    const void *odd = (const uint8_t *)&right + 1;
    EXPECT(MISALIGNED, leastaction_step2(&model, &state, 0.01f, zero, zero, N, odd, NULL, &error));
    REQUIRE(error.numbers[0] == 7 && memcmp(&before, &state, sizeof state) == 0);
    /* A residual that no update leaves. */
    leastaction_newton strict = right;
    strict.max_iterations = 1;
    strict.accept = 1e-30f;
    EXPECT(NOT_CONVERGED, leastaction_step2(&model, &state, 0.01f, zero, zero, N, &strict, NULL, &error));
    REQUIRE(error.numbers[0] == 1 && error.residual > 0 && memcmp(&before, &state, sizeof state) == 0);
    EXPECT(OK, leastaction_step2(&model, &state, 0.01f, zero, zero, N, &right, NULL, &error));
}

static void refused_steps(void) {
    const float h = 0.01f, nan[N] = {NAN}, huge[N] = {1e30f};
    before = state;
    EXPECT(NULL_POINTER, leastaction_step4(&model, NULL, h, zero, zero, N, NULL, NULL, &error));
    REQUIRE(error.numbers[0] == 2);
    EXPECT(NULL_POINTER, leastaction_step4(&model, &state, h, NULL, zero, N, NULL, NULL, &error));
    EXPECT(NULL_POINTER, leastaction_step4(&model, &state, h, zero, NULL, N, NULL, NULL, &error));
    EXPECT(WRONG_LENGTH, leastaction_step4(&model, &state, h, zero, zero, 0, NULL, NULL, &error));
    EXPECT(BAD_STEP, leastaction_step4(&model, &state, 0, zero, zero, N, NULL, NULL, &error));
    EXPECT(BAD_STEP, leastaction_step4(&model, &state, -h, zero, zero, N, NULL, NULL, &error));
    EXPECT(BAD_STEP, leastaction_step2(&model, &state, NAN, zero, zero, N, NULL, NULL, &error));
    EXPECT(NOT_FINITE, leastaction_step2(&model, &state, h, nan, zero, N, NULL, NULL, &error));
    EXPECT(NOT_FINITE, leastaction_step4(&model, &state, h, zero, nan, N, NULL, NULL, &error));
    EXPECT(NOT_FINITE, leastaction_start_from_positions4(&model, &state, h, nan, zero, zero, zero, N, &error));
    EXPECT(BAD_STEP, leastaction_start_from_positions2(&model, &state, 0, zero, zero, zero, zero, N, &error));
    leastaction_status far = leastaction_step4(&model, &state, 100, huge, huge, N, NULL, NULL, &error);
    /* End stops hold against any force. */
    if (far == LEASTACTION_STATUS_OK) {
        state = before;
    } else {
        REQUIRE(far >= LEASTACTION_STATUS_SINGULAR && far == error.status);
        REQUIRE(memcmp(&before, &state, sizeof state) == 0);
    }
    float x[N];
    EXPECT(NULL_POINTER, leastaction_state_q(&state, N, NULL, &error));
    EXPECT(WRONG_LENGTH, leastaction_state_w(&state, N - 1, x, &error));
    EXPECT(OK, leastaction_step4(&model, &state, h, zero, zero, N, NULL, NULL, &error));
}

#ifdef RING
/* The ring's rods: from the origin to node 0, and from node 0 to node 2. */
static void rods(void) {
    float h = 0.01f, off[N], x[N], lambda[LEASTACTION_RODS];
    memcpy(off, q, sizeof off);
    off[4] += 0.01f;
    before = state;
    EXPECT(ROD_VIOLATED, leastaction_start(&model, &state, off, zero, N, &error));
    REQUIRE(error.numbers[0] == 1 && error.residual > 0.001f && error.residual < 0.01f);
    EXPECT(ROD_VIOLATED, leastaction_start_from_positions2(&model, &state, h, q, off, zero, zero, N, &error));
    EXPECT(ROD_VIOLATED, leastaction_start_from_positions4(&model, &state, h, off, q, zero, zero, N, &error));
    /* At the origin the first rod has no direction. */
    memcpy(off, q, sizeof off);
    off[0] = off[1] = 0;
    EXPECT(ROD_REDUNDANT, leastaction_acceleration(&model, off, zero, zero, N, x, &error));
    REQUIRE(error.numbers[0] == 0 && memcmp(&before, &state, sizeof state) == 0);
    EXPECT(NULL_POINTER, leastaction_state_lambda(&state, LEASTACTION_RODS, NULL, &error));
    REQUIRE(error.numbers[0] == 3);
    EXPECT(WRONG_LENGTH, leastaction_state_lambda(&state, LEASTACTION_RODS + 1, lambda, &error));
    EXPECT(OK, leastaction_start(&model, &state, q, zero, N, &error));
    EXPECT(OK, leastaction_state_lambda(&state, LEASTACTION_RODS, lambda, &error));
    REQUIRE(lambda[0] == 0 && lambda[1] == 0);
    EXPECT(OK, leastaction_step2(&model, &state, h, zero, zero, N, NULL, NULL, &error));
    EXPECT(OK, leastaction_state_lambda(&state, LEASTACTION_RODS, lambda, &error));
    REQUIRE(lambda[0] != 0 && lambda[1] != 0 && lambda[LEASTACTION_RODS - 1] == 0);
    EXPECT(GRAPH_COORDINATES, leastaction_load(&other, sizeof other, LEASTACTION_ABI, file, bytes, "pair", &error));
    REQUIRE(error.numbers[0] == 4 && error.numbers[1] == N);
}
#endif

int errors(void) {
    bytes = (size_t)(model_file_end - model_file);
    REQUIRE(bytes <= FILE_MOST);
    REQUIRE(leastaction_family()[0] != '\0' && leastaction_message(-1)[0] == 'u');
    memcpy(file, model_file, bytes);
    EXPECT(OK, load(bytes));
    damaged();
    misplaced();
    arguments();
    said();
#ifdef WHOLE_FILE
    whole();
#endif
    starts();
    refused_bounds();
    refused_steps();
#ifdef RING
    rods();
#endif
    put(failures == 0 ? "errors as they should be\n" : "errors not as they should be\n");
    return failures != 0;
}
