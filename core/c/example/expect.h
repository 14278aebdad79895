/* Shared by the parts that provoke errors. */
#ifndef EXPECT_H
#define EXPECT_H

#include "example.h"

#define CRC_BYTES 4

static leastaction_error error;
static int failures;

static inline void require(const char *file, int line, int holds, const char *what) {
    if (holds) return;
    failures++;
    put(file);
    put(":");
    put_number((uint64_t)line, 10);
    put(": ");
    put(what);
    put("\n");
}

#define REQUIRE(condition) require(__FILE__, __LINE__, condition, #condition)
#define EXPECT(name, call) expect(__FILE__, __LINE__, call, LEASTACTION_STATUS_##name)

/* Checks that the function returns the expected status, and fills in an error that agrees. */
static inline void expect(const char *file, int line, leastaction_status found, leastaction_status expected) {
    require(file, line, found == expected, leastaction_message(found));
    require(file, line, error.status == found, "another status in the error");
}

/* CRC-32 of some bytes, by whose last four a file is checked. */
static inline void checksum(uint8_t *all, size_t length) {
    uint32_t crc = UINT32_MAX;
    for (size_t i = 0; i < length - CRC_BYTES; i++) {
        crc ^= all[i];
        for (int bit = 0; bit < 8; bit++) crc = (crc >> 1) ^ (0xedb88320u & (0u - (crc & 1)));
    }
    crc = ~crc;
    for (int byte = 0; byte < CRC_BYTES; byte++) all[length - CRC_BYTES + (size_t)byte] = (uint8_t)(crc >> (8 * byte));
}

#endif
