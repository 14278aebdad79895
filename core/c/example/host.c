/* The example on a desk. */
#include "example.h"
#include <stdio.h>

void put(const char *text) {
    fputs(text, stdout);
}
