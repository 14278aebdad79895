#include "example.h"

void put_number(uint64_t number, unsigned base) {
    char text[24];
    size_t at = sizeof text;
    text[--at] = '\0';
    do {
        text[--at] = "0123456789abcdef"[number % base];
        number /= base;
    } while (number != 0 && at > 0);
    put(&text[at]);
}

int main(void) {
    int failed = trace();
    failed |= errors();
    failed |= follow();
    failed |= plan_errors();
#ifdef SETTINGS_FILE
    failed |= adapt();
    failed |= adapt_errors();
#endif
    return failed;
}
