/* Checks that damaged settings and patches are refused or can be followed, and that every error has its own status and changes nothing. */
#include "expect.h"
#include <math.h>

#define FILE_MOST 1024

static leastaction_adapter adapter, other;
static leastaction_model model;
static uint8_t settings[FILE_MOST], patch[LEASTACTION_PATCH_BYTES];
static size_t model_bytes, bytes, patch_bytes;
static float h;
static const float zero[N], q[N] = {MODEL_Q};

static leastaction_status begin(size_t length) {
    return leastaction_adapter_begin(&adapter, sizeof adapter, LEASTACTION_ABI, model_file, model_bytes, settings, length, h, &error);
}

static leastaction_status restore(size_t length) {
    return leastaction_adapter_restore(&adapter, patch, length, &error);
}

static uint64_t in_use(void) {
    leastaction_found found;
    uint64_t hash = HASH;
    EXPECT(OK, leastaction_adapter_found(&adapter, &found, &error));
    for (uint32_t i = 0; i < found.numbers; i++) {
        leastaction_number number;
        EXPECT(OK, leastaction_adapter_number(&adapter, i, &number, &error));
        REQUIRE(number.least <= number.in_use && number.in_use <= number.most);
        hash = hashed(hash, (float[]){number.estimate, number.standard_error, number.in_use}, 3);
    }
    return hash;
}

/* An adapter that has begun takes ticks, whatever they are, and keeps its numbers within their limits. */
static void followed(unsigned ticks) {
    float x[N], u[N];
    for (unsigned tick = 0; tick < ticks; tick++) {
        for (int i = 0; i < N; i++) {
            x[i] = q[i] + (float)(tick * tick % 16) / 64;
            u[i] = (float)(tick % 8) - 4;
        }
        EXPECT(OK, leastaction_adapter_tick(&adapter, x, u, N, &error));
    }
    in_use();
    leastaction_status status = leastaction_gravity_torque(&adapter.model, q, N, u, &error);
    REQUIRE(status == LEASTACTION_STATUS_OK || status == LEASTACTION_STATUS_NOT_FINITE);
}

/* Every truncation, and every change of a bit: by itself it is found by the checksum, under a right checksum by the checks behind it. */
static void damaged(uint8_t *file, size_t length, leastaction_status (*read)(size_t), leastaction_status first, unsigned ticks) {
    unsigned accepted = 0;
    for (size_t shorter = 0; shorter < length; shorter++) {
        leastaction_status found = read(shorter);
        REQUIRE(found == first || found == first + 3);
    }
    for (size_t i = 0; i < length; i++) {
        file[i] ^= (uint8_t)(1u << i % 8);
        REQUIRE(read(length) == (i < 4 ? first + 1 : i == 4 ? first + 2 : first + 3));
        file[i] ^= (uint8_t)(1u << i % 8);
    }
    for (size_t bit = 0; bit < 8 * (length - CRC_BYTES); bit++) {
        file[bit / 8] ^= (uint8_t)(1u << bit % 8);
        checksum(file, length);
        leastaction_status found = read(length);
        REQUIRE(found == LEASTACTION_STATUS_OK || found > first);
        if (found == LEASTACTION_STATUS_OK) {
            accepted++;
            followed(ticks);
        }
        file[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    /* Most bits are of numbers, of which many may be others. */
    REQUIRE(accepted > length);
    checksum(file, length);
    EXPECT(OK, read(length));
}

static void misplaced(void) {
    leastaction_found found;
    void *odd = (uint8_t *)&other + 1;
    size_t size = sizeof other;
    const uint32_t abi = LEASTACTION_ABI;
    EXPECT(NULL_POINTER, leastaction_adapter_begin(NULL, size, abi, model_file, model_bytes, settings, bytes, h, &error));
    EXPECT(NULL_POINTER, leastaction_adapter_begin(&other, size, abi, NULL, model_bytes, settings, bytes, h, &error));
    REQUIRE(error.numbers[0] == 4);
    EXPECT(NULL_POINTER, leastaction_adapter_begin(&other, size, abi, model_file, model_bytes, NULL, bytes, h, &error));
    REQUIRE(error.numbers[0] == 6);
    EXPECT(MISALIGNED, leastaction_adapter_begin(odd, size, abi, model_file, model_bytes, settings, bytes, h, &error));
    EXPECT(WRONG_LENGTH, leastaction_adapter_begin(&other, size + 4, abi, model_file, model_bytes, settings, bytes, h, &error));
    EXPECT(WRONG_LENGTH, leastaction_adapter_begin(&other, size, abi, model_file, model_bytes, settings, SIZE_MAX, h, &error));
    EXPECT(OTHER_ABI, leastaction_adapter_begin(&other, size, 1, model_file, model_bytes, settings, bytes, h, &error));
    EXPECT(BAD_STEP, leastaction_adapter_begin(&other, size, abi, model_file, model_bytes, settings, bytes, NAN, &error));
    EXPECT(SETTINGS_OTHER_TICK, leastaction_adapter_begin(&other, size, abi, model_file, model_bytes, settings, bytes, 2 * h, &error));
    EXPECT(CHECKSUM, leastaction_adapter_begin(&other, size, abi, model_file, model_bytes - 4, settings, bytes, h, &error));
    EXPECT(NOT_SETTINGS, leastaction_adapter_begin(&other, size, abi, model_file, model_bytes, model_file, model_bytes, h, &error));
    size_t length = (size_t)(machine_file_end - machine_file);
    EXPECT(SETTINGS_OTHER_MODEL, leastaction_adapter_begin(&other, size, abi, machine_file, length, settings, bytes, h, &error));
    EXPECT(NO_ADAPTER, leastaction_adapter_skip(&other, &error));
    EXPECT(NOT_LOADED, leastaction_gravity_torque(&other.model, zero, N, (float[N]){0}, &error));
    EXPECT(OK, begin(bytes));
    other = adapter;
    EXPECT(NO_ADAPTER, leastaction_adapter_found(&other, &found, &error));
    EXPECT(NOT_LOADED, leastaction_gravity_torque(&other.model, zero, N, (float[N]){0}, &error));
}

static void arguments(void) {
    static uint8_t memory[LEASTACTION_PATCH_BYTES];
    const float nan[N] = {NAN};
    leastaction_found found;
    leastaction_number number;
    size_t written = 7;
    followed(64);
    uint64_t before = in_use();
    EXPECT(NULL_POINTER, leastaction_adapter_tick(NULL, zero, zero, N, &error));
    EXPECT(NULL_POINTER, leastaction_adapter_tick(&adapter, NULL, zero, N, &error));
    EXPECT(NULL_POINTER, leastaction_adapter_tick(&adapter, zero, NULL, N, &error));
    REQUIRE(error.numbers[0] == 3);
    EXPECT(WRONG_LENGTH, leastaction_adapter_tick(&adapter, zero, zero, N + 1, &error));
    EXPECT(NOT_FINITE, leastaction_adapter_tick(&adapter, nan, zero, N, &error));
    EXPECT(NOT_FINITE, leastaction_adapter_tick(&adapter, zero, nan, N, &error));
    EXPECT(NULL_POINTER, leastaction_adapter_skip(NULL, &error));
    EXPECT(NULL_POINTER, leastaction_adapter_freeze(NULL, 1, &error));
    EXPECT(NULL_POINTER, leastaction_adapter_found(&adapter, NULL, &error));
    EXPECT(NULL_POINTER, leastaction_adapter_number(&adapter, 0, NULL, &error));
    EXPECT(NO_NUMBER, leastaction_adapter_number(&adapter, LEASTACTION_NUMBERS, &number, &error));
    REQUIRE(error.numbers[0] == LEASTACTION_NUMBERS);
    EXPECT(WRONG_LENGTH, leastaction_adapter_save(&adapter, memory, sizeof memory - 1, &written, &error));
    EXPECT(NULL_POINTER, leastaction_adapter_save(&adapter, memory, sizeof memory, NULL, &error));
    EXPECT(NULL_POINTER, leastaction_adapter_restore(&adapter, NULL, 20, &error));
    EXPECT(NOT_A_PATCH, leastaction_adapter_restore(&adapter, settings, bytes, &error));
    REQUIRE(written == 7 && memory[0] == 0 && in_use() == before);
    EXPECT(OK, leastaction_adapter_freeze(&adapter, 1, &error));
    EXPECT(OK, leastaction_adapter_found(&adapter, &found, &error));
    REQUIRE(found.frozen == 1 && found.numbers > 0);
    followed(64);
    REQUIRE(in_use() == before);
    EXPECT(OK, leastaction_adapter_freeze(&adapter, 0, &error));
    followed(64);
    REQUIRE(in_use() != before);
}

/* The model of an adapter that has learned nothing is that of the file. */
static void same_model(void) {
    float own[N], of_file[N];
    EXPECT(OK, leastaction_inverse_dynamics(&adapter.model, q, q, q, N, own, &error));
    EXPECT(OK, leastaction_inverse_dynamics(&model, q, q, q, N, of_file, &error));
    REQUIRE(memcmp(own, of_file, sizeof own) == 0);
}

int adapt_errors(void) {
    uint8_t order, control;
    model_bytes = (size_t)(model_file_end - model_file);
    bytes = (size_t)(settings_file_end - settings_file);
    REQUIRE(bytes <= FILE_MOST);
    memcpy(settings, settings_file, bytes);
    EXPECT(OK, leastaction_load(&model, sizeof model, LEASTACTION_ABI, model_file, model_bytes, NULL, &error));
    EXPECT(OK, leastaction_trained_step(&model, &h, &order, &control, &error));
    h /= 8;
    damaged(settings, bytes, begin, LEASTACTION_STATUS_SETTINGS_TOO_SHORT, 16);
    same_model();
    misplaced();
    arguments();
    EXPECT(OK, leastaction_adapter_save(&adapter, patch, sizeof patch, &patch_bytes, &error));
    damaged(patch, patch_bytes, restore, LEASTACTION_STATUS_PATCH_TOO_SHORT, 4);
    put(failures == 0 ? "adapters as they should be\n" : "adapters not as they should be\n");
    return failures != 0;
}
