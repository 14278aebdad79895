/* The example on a Cortex-M4F: start-up, and output by semihosting to a debugger or an emulator. */
#include "example.h"

extern uint32_t stack_top, data_from, data_start, data_end, bss_start, bss_end;
int main(void);
void start(void);
static void fault(void);

/* Stack, reset, and the faults; interrupts are never enabled. */
__attribute__((section(".vectors"), used)) static const struct {
    const uint32_t *stack;
    void (*handlers[6])(void);
} vectors = {&stack_top, {start, fault, fault, fault, fault, fault}};

static int semihosting(int operation, const void *argument) {
    register int r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void leave(int failed) {
    /* SYS_EXIT because of ADP_Stopped_ApplicationExit, or of a run-time error. */
    semihosting(0x18, (const void *)(failed ? 0x20023 : 0x20026));
    for (;;) {}
}

void put(const char *text) {
    semihosting(0x04, text);
}

static void fault(void) {
    put("fault\n");
    leave(1);
}

void start(void) {
    /* The floating-point unit is off after a reset: CPACR. */
    *(volatile uint32_t *)0xe000ed88 |= 0xf << 20;
    __asm__ volatile("dsb\n isb");
    for (uint32_t *to = &data_start, *from = &data_from; to < &data_end;) *to++ = *from++;
    for (uint32_t *to = &bss_start; to < &bss_end;) *to++ = 0;
    leave(main());
}
