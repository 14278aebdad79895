/* Checks that every damaged plan is refused or can be followed, and that every error has its own status and changes nothing. */
#include "expect.h"
#include <math.h>

#define FILE_MOST 4096

static leastaction_model model, another;
static leastaction_plan plan, other;
static _Alignas(4) uint8_t file[FILE_MOST + 4], model_copy[FILE_MOST];
static size_t bytes;
static const float zero[N];

static leastaction_status load(size_t length) {
    return leastaction_plan_load(&plan, sizeof plan, LEASTACTION_ABI, file, length, &model, &error);
}

static int finite(const float *x) {
    for (int i = 0; i < N; i++) {
        if (!isfinite(x[i])) return 0;
    }
    return 1;
}

static int too_large(leastaction_status status) {
    return status == LEASTACTION_STATUS_NOT_FINITE || status == LEASTACTION_STATUS_TOO_FAR_FROM_PLAN;
}

/* A plan that was accepted says finite numbers or why not, and commands within its limits. */
static void followed(void) {
    static const uint32_t ticks[] = {0, 1, 9, 47, 48, UINT32_MAX};
    leastaction_plan_description description;
    uint8_t driven[N];
    float least[N], most[N], q[N], v[N], u[N];
    EXPECT(OK, leastaction_plan_describe(&plan, &description, &error));
    EXPECT(OK, leastaction_plan_limits(&plan, N, driven, least, most, &error));
    REQUIRE(description.coordinates == N && description.h > 0 && isfinite(description.seconds) && description.ticks > 0);
    for (size_t i = 0; i < sizeof ticks / sizeof *ticks; i++) {
        leastaction_status status = leastaction_plan_reference(&plan, ticks[i], N, q, v, u, &error);
        REQUIRE(too_large(status) || (status == LEASTACTION_STATUS_OK && finite(q) && finite(v) && finite(u)));
        status = leastaction_plan_motion(&plan, (float)ticks[i] * 0.00625f, N, q, v, u, &error);
        REQUIRE(too_large(status) || (status == LEASTACTION_STATUS_OK && finite(q) && finite(v) && finite(u)));
        status = leastaction_plan_command(&plan, ticks[i], zero, zero, N, u, &error);
        REQUIRE(too_large(status) || status == LEASTACTION_STATUS_OK);
        for (int k = 0; status == LEASTACTION_STATUS_OK && k < N; k++) REQUIRE(least[k] <= u[k] && u[k] <= most[k]);
    }
}

static leastaction_status of_byte(size_t position) {
    if (position < 4) return LEASTACTION_STATUS_NOT_A_PLAN;
    return position == 4 ? LEASTACTION_STATUS_PLAN_VERSION : LEASTACTION_STATUS_PLAN_CHECKSUM;
}

/* Every truncation, and every change of a bit: by itself it is found by the checksum, under a right checksum by the checks behind it. */
static void damaged(void) {
    unsigned accepted = 0;
    for (size_t length = 0; length < bytes; length++) {
        leastaction_status found = load(length);
        REQUIRE(found == LEASTACTION_STATUS_PLAN_TOO_SHORT || found == LEASTACTION_STATUS_PLAN_CHECKSUM);
    }
    for (size_t i = 0; i < bytes; i++) {
        file[i] ^= (uint8_t)(1u << i % 8);
        expect(__FILE__, __LINE__, load(bytes), of_byte(i));
        file[i] ^= (uint8_t)(1u << i % 8);
    }
    for (size_t bit = 0; bit < 8 * (bytes - CRC_BYTES); bit++) {
        file[bit / 8] ^= (uint8_t)(1u << bit % 8);
        checksum(file, bytes);
        leastaction_status found = load(bytes);
        REQUIRE(found == LEASTACTION_STATUS_OK || found >= LEASTACTION_STATUS_PLAN_TOO_SHORT);
        if (found == LEASTACTION_STATUS_OK) {
            accepted++;
            followed();
        } else {
            EXPECT(NO_PLAN, leastaction_plan_command(&plan, 0, zero, zero, N, (float[N]){0}, &error));
        }
        file[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    /* Most bits are of numbers, of which nearly every one is a plan. */
    REQUIRE(accepted > bytes);
    /* Fewer numbers than the header needs. */
    checksum(file, bytes - 4);
    EXPECT(PLAN_NUMBER_COUNT, load(bytes - 4));
    REQUIRE(error.numbers[0] + 4 == error.numbers[1]);
    memcpy(file, plan_file, bytes);
}

static void misplaced(void) {
    void *odd = (uint8_t *)&other + 1;
    leastaction_plan_description description;
    EXPECT(NULL_POINTER, leastaction_plan_load(NULL, sizeof other, LEASTACTION_ABI, file, bytes, &model, &error));
    EXPECT(NULL_POINTER, leastaction_plan_load(&other, sizeof other, LEASTACTION_ABI, NULL, bytes, &model, &error));
    REQUIRE(error.numbers[0] == 4);
    EXPECT(NULL_POINTER, leastaction_plan_load(&other, sizeof other, LEASTACTION_ABI, file, bytes, NULL, &error));
    REQUIRE(error.numbers[0] == 6);
    EXPECT(NOT_LOADED, leastaction_plan_load(&other, sizeof other, LEASTACTION_ABI, file, bytes, &another, &error));
    EXPECT(OTHER_ABI, leastaction_plan_load(&other, sizeof other, 1, file, bytes, &model, &error));
    EXPECT(WRONG_LENGTH, leastaction_plan_load(&other, sizeof other + 4, LEASTACTION_ABI, file, bytes, &model, &error));
    EXPECT(WRONG_LENGTH, leastaction_plan_load(&other, sizeof other, LEASTACTION_ABI, file, SIZE_MAX, &model, &error));
    EXPECT(MISALIGNED, leastaction_plan_load(odd, sizeof other, LEASTACTION_ABI, file, bytes, &model, &error));
    EXPECT(NOT_A_PLAN, leastaction_plan_load(&other, sizeof other, LEASTACTION_ABI, model_file, bytes, &model, &error));
    EXPECT(NO_PLAN, leastaction_plan_describe(&other, &description, &error));
    memmove(file + 1, file, bytes);
    EXPECT(PLAN_UNALIGNED, leastaction_plan_load(&other, sizeof other, LEASTACTION_ABI, file + 1, bytes, &model, &error));
    memmove(file, file + 1, bytes);
    EXPECT(OK, load(bytes));
    other = plan;
    EXPECT(NO_PLAN, leastaction_plan_describe(&other, &description, &error));
}

/* A model that differs in a digit of a weight, and so in its checksum. */
static void other_model(void) {
    size_t length = (size_t)(model_file_end - model_file);
    memcpy(model_copy, model_file, length);
    model_copy[length - 8] ^= 1;
    checksum(model_copy, length);
    EXPECT(OK, leastaction_load(&another, sizeof another, LEASTACTION_ABI, model_copy, length, MODEL_NAME, &error));
    EXPECT(PLAN_OTHER_MODEL, leastaction_plan_load(&other, sizeof other, LEASTACTION_ABI, file, bytes, &another, &error));
    uint32_t stored;
    memcpy(&stored, model_file + length - CRC_BYTES, sizeof stored);
    REQUIRE(error.numbers[0] == stored && error.numbers[1] != stored);
}

static void arguments(void) {
    float x[3][N];
    uint8_t marks[N] = {0};
    const float nan[N] = {NAN}, far[N] = {3e38f};
    leastaction_plan_description description;
    EXPECT(OK, load(bytes));
    EXPECT(OK, leastaction_plan_describe(&plan, &description, &error));
    REQUIRE(description.coordinates == N && description.driven == (N > 1 ? 2 : 1) && description.ticks_per_node == 8);
    REQUIRE(description.ticks == 48 && description.h == 0.00625f && description.seconds == 48 * 0.00625f);
    EXPECT(OK, leastaction_plan_limits(&plan, N, marks, x[0], x[1], &error));
    REQUIRE(marks[0] == 1 && marks[N - 1] == 1 && x[0][0] == -0.375f && x[1][0] == 0.5f);
    REQUIRE(N < 3 || (marks[1] == 0 && x[0][1] == 0 && x[1][1] == 0));
    EXPECT(NULL_POINTER, leastaction_plan_describe(&plan, NULL, &error));
    EXPECT(WRONG_LENGTH, leastaction_plan_limits(&plan, N + 1, marks, x[0], x[1], &error));
    EXPECT(NULL_POINTER, leastaction_plan_limits(&plan, N, NULL, x[0], x[1], &error));
    EXPECT(NULL_POINTER, leastaction_plan_command(NULL, 0, zero, zero, N, x[0], &error));
    EXPECT(NULL_POINTER, leastaction_plan_command(&plan, 0, zero, NULL, N, x[0], &error));
    REQUIRE(error.numbers[0] == 4);
    EXPECT(NULL_POINTER, leastaction_plan_command(&plan, 0, zero, zero, N, NULL, &error));
    REQUIRE(error.numbers[0] == 6);
    EXPECT(WRONG_LENGTH, leastaction_plan_command(&plan, 0, zero, zero, N - 1, x[0], &error));
    EXPECT(NOT_FINITE, leastaction_plan_command(&plan, 0, nan, zero, N, x[0], &error));
    EXPECT(NOT_FINITE, leastaction_plan_command_at(&plan, 0, zero, nan, N, x[0], &error));
    EXPECT(NOT_FINITE, leastaction_plan_command_at(&plan, NAN, zero, zero, N, x[0], &error));
    EXPECT(NOT_FINITE, leastaction_plan_motion(&plan, INFINITY, N, x[0], x[1], x[2], &error));
    EXPECT(NOT_FINITE, leastaction_plan_reference_at(&plan, NAN, N, x[0], x[1], x[2], &error));
    EXPECT(WRONG_LENGTH, leastaction_plan_reference(&plan, 0, 0, x[0], x[1], x[2], &error));
    EXPECT(NULL_POINTER, leastaction_plan_reference(&plan, 0, N, x[0], x[1], NULL, &error));
    REQUIRE(error.numbers[0] == 6);
    EXPECT(NULL_POINTER, leastaction_plan_motion(&plan, 0, N, NULL, x[1], x[2], &error));
    EXPECT(NULL_POINTER, leastaction_plan_turns(&plan, zero, NULL, N, x[0], &error));
    EXPECT(NOT_FINITE, leastaction_plan_turns(&plan, nan, marks, N, x[0], &error));
    /* Far from the plan a command is at a limit, or no number: never beyond. */
    leastaction_status status = leastaction_plan_command(&plan, 0, far, zero, N, x[2], &error);
    REQUIRE(status == LEASTACTION_STATUS_TOO_FAR_FROM_PLAN || x[2][0] == -0.375f);
}

int plan_errors(void) {
    bytes = (size_t)(plan_file_end - plan_file);
    REQUIRE(bytes <= FILE_MOST && (size_t)(model_file_end - model_file) <= FILE_MOST);
    memcpy(file, plan_file, bytes);
    size_t length = (size_t)(model_file_end - model_file);
    EXPECT(OK, leastaction_load(&model, sizeof model, LEASTACTION_ABI, model_file, length, MODEL_NAME, &error));
    damaged();
    misplaced();
    other_model();
    arguments();
    put(failures == 0 ? "plans as they should be\n" : "plans not as they should be\n");
    return failures != 0;
}
