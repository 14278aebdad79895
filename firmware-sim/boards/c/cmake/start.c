/* Start-up of a Cortex-M4F: vectors, memory, the floating-point unit; faults reset the chip, whose pins are then inputs: the drive stops. */
#include <stddef.h>
#include <stdint.h>

extern uint32_t stack_top, data_from, data_start, data_end, bss_start, bss_end;
void start(void);
void tick(void);
_Noreturn void run(void);

static void fault(void) {
    /* AIRCR: a system reset. */
    *(volatile uint32_t *)0xe000ed0c = 0x05fa0004;
    for (;;) {}
}

/* Stack, reset, faults, and SysTick, the fifteenth. */
__attribute__((section(".vectors"), used)) static const struct {
    const uint32_t *stack;
    void (*handlers[15])(void);
} vectors = {&stack_top,
             {start, fault, fault, fault, fault, fault, NULL, NULL, NULL, NULL, fault, fault, NULL, fault, tick}};

void start(void) {
    /* CPACR: the unit is off after a reset. */
    *(volatile uint32_t *)0xe000ed88 |= 0xfu << 20;
    __asm__ volatile("dsb\n isb");
    for (uint32_t *to = &data_start, *from = &data_from; to < &data_end;) *to++ = *from++;
    for (uint32_t *to = &bss_start; to < &bss_end;) *to++ = 0;
    run();
}
