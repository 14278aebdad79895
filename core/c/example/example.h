/* Shared by the parts of the example. */
#ifndef EXAMPLE_H
#define EXAMPLE_H

#include "leastaction.h"
#include <string.h>

#define N LEASTACTION_COORDINATES

/* The model file, in flash: model.S. */
extern const uint8_t model_file[], model_file_end[];

/* The tree or the graph to take from it. */
#ifndef MODEL_NAME
#define MODEL_NAME NULL
#endif

/* Initial position of the mechanism: N numbers, separated by commas. */
#ifndef MODEL_Q
#error "define MODEL_Q"
#endif

#ifdef PLAN_FILE
/* A plan for the model, in flash: model.S. */
extern const uint8_t plan_file[], plan_file_end[];
#endif

#ifdef SETTINGS_FILE
/* Settings of an adapter for the model, and the model of a machine that carries a load, in flash: model.S. */
extern const uint8_t settings_file[], settings_file_end[], machine_file[], machine_file_end[];
#endif

/* Start of an FNV-1a hash. */
#define HASH 0xcbf29ce484222325u

/* The hash after the bits of some numbers. */
static inline uint64_t hashed(uint64_t hash, const float *x, size_t count) {
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &x[i], sizeof bits);
        for (int byte = 0; byte < 4; byte++) {
            hash = (hash ^ (bits >> (8 * byte) & 0xff)) * 0x100000001b3u;
        }
    }
    return hash;
}

/* Provided by the platform: chip.c or host.c. */
void put(const char *text);

/* Prints a number in the given base. */
void put_number(uint64_t number, unsigned base);

/* Prints what was refused, and why; returns 1. */
static inline int refused(const char *what, const leastaction_error *error) {
    put(what);
    put(": ");
    put(leastaction_message(error->status));
    put("\n");
    return 1;
}

/* Steps the model and prints a hash of all results; returns 0 if all went well. */
int trace(void);

/* Provokes errors and prints those that are not as expected; returns 0 if there are none. */
int errors(void);

/* Follows the plan and prints a hash of all results; returns 0 if all went well. */
int follow(void);

/* Provokes errors of plans like errors(). */
int plan_errors(void);

/* Lets the model follow a machine and prints a hash of all results; returns 0 if all went well. */
int adapt(void);

/* Provokes errors of adapters like errors(). */
int adapt_errors(void);

#endif
