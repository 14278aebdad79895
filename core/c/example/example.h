/* Shared by the parts of the example. */
#ifndef EXAMPLE_H
#define EXAMPLE_H

#include "leastaction.h"

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

/* Provided by the platform: chip.c or host.c. */
void put(const char *text);

/* Prints a number in the given base. */
void put_number(uint64_t number, unsigned base);

/* Steps the model and prints a hash of all results; returns 0 if all went well. */
int trace(void);

/* Provokes errors and prints those that are not as expected; returns 0 if there are none. */
int errors(void);

#endif
