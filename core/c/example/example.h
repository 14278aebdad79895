/* What the parts of the example share. */
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

/* Where the mechanism starts: N numbers, with commas between. */
#ifndef MODEL_Q
#error "define MODEL_Q"
#endif

/* What a platform offers: chip.c or host.c. */
void put(const char *text);

/* A number in digits of this base. */
void put_number(uint64_t number, unsigned base);

/* Steps the model and prints a hash of everything; 0 where all went well. */
int trace(void);

/* Provokes errors and prints those that are not as they should be; 0 where there are none. */
int errors(void);

#endif
