/* The board, a Nucleo F446RE: a tick of SysTick, two incremental encoders on timers, a drive by PWM and direction, a watchdog. */
#include "machine.h"

#define REGISTER(address) (*(volatile uint32_t *)(address))
enum { RCC = 0x40023800, GPIOA = 0x40020000, GPIOB = 0x40020400, TIM1 = 0x40010000, TIM3 = 0x40000400, TIM4 = 0x40000800 };
enum { IWDG = 0x40003000 };
#define SYSTICK 0xe000e010u

/* The crystal of the programmer, 8 MHz, is enough for a plan and exact; an internal oscillator is up to 1% off. */
static const float clock = 8e6f;
/* 20 kHz. */
enum { TOP = 400 };
/* The watchdog resets the chip, which stops the drive, after this many periods without a tick. */
static const float patience = 5;

static machine loop;
static volatile uint32_t now;

void tick(void);
_Noreturn void run(void);

void tick(void) {
    now++;
}

static void set_clock(void) {
    REGISTER(RCC) |= 1u << 18 | 1u << 16;
    while (!(REGISTER(RCC) & 1u << 17)) {}
    REGISTER(RCC + 0x08) |= 1;
    REGISTER(RCC + 0x30) |= 3;
    REGISTER(RCC + 0x40) |= 6;
    REGISTER(RCC + 0x44) |= 1;
}

/* Gives a pin, of the first eight or the others, to a timer. */
static void give(uint32_t port, uint32_t pin, uint32_t function) {
    REGISTER(port) = (REGISTER(port) & ~(3u << 2 * pin)) | 2u << 2 * pin;
    REGISTER(port + 0x20 + (pin >> 3) * 4) |= function << 4 * (pin & 7);
}

static void output(uint32_t port, uint32_t pin) {
    REGISTER(port) = (REGISTER(port) & ~(3u << 2 * pin)) | 1u << 2 * pin;
}

static void write(uint32_t port, uint32_t pin, int high) {
    REGISTER(port + 0x18) = 1u << (pin + (high ? 0 : 16));
}

static void count_edges(uint32_t timer) {
    REGISTER(timer + 0x18) = 0x0101;
    REGISTER(timer + 0x08) = 3;
    REGISTER(timer + 0x2c) = 0xffff;
    REGISTER(timer) = 1;
}

/* CHANGE 5: the pins of encoders (A6 and A7, B6 and B7) and drive (A8, direction B5); the light is A5. */
static void set_pins(void) {
    give(GPIOA, 6, 2), give(GPIOA, 7, 2), give(GPIOB, 6, 2), give(GPIOB, 7, 2), give(GPIOA, 8, 1);
    output(GPIOB, 5), output(GPIOA, 5);
    count_edges(TIM3), count_edges(TIM4);
    REGISTER(TIM1 + 0x2c) = TOP - 1;
    REGISTER(TIM1 + 0x18) = 0x68;
    REGISTER(TIM1 + 0x20) = 1;
    REGISTER(TIM1 + 0x44) = 1u << 15;
    REGISTER(TIM1 + 0x14) = 1;
    REGISTER(TIM1) = 1;
}

static void drive(float duty) {
    write(GPIOB, 5, duty < 0);
    REGISTER(TIM1 + 0x34) = (uint32_t)((duty < 0 ? -duty : duty) * TOP);
}

static void start_ticks(float period) {
    REGISTER(SYSTICK + 4) = (uint32_t)(period * clock) - 1;
    REGISTER(SYSTICK + 8) = 0;
    REGISTER(SYSTICK) = 7;
    /* 8 kHz: a quarter of the watchdog's oscillator. */
    REGISTER(IWDG) = 0x5555;
    REGISTER(IWDG + 8) = (uint32_t)(patience * period * 8e3f);
    REGISTER(IWDG) = 0xcccc;
}

_Noreturn void run(void) {
    int32_t counts[MACHINE_N] = {0};
    set_clock();
    set_pins();
    /* A model or a plan that is refused never moves the machine: the light stays off. */
    if (machine_begin(&loop) != LEASTACTION_STATUS_OK) {
        for (;;) {}
    }
    start_ticks(machine_period(&loop));
    for (uint32_t last = 0;;) {
        float duty;
        while (now == last) __asm__ volatile("wfi");
        uint32_t elapsed = now - last;
        last += elapsed;
        /* CHANGE 5: one encoder for every coordinate. */
        _Static_assert(MACHINE_N == 2, "read as many encoders here as the machine has coordinates");
        counts[0] = machine_count(counts[0], (int32_t)REGISTER(TIM3 + 0x24), 1 << 16);
        counts[1] = machine_count(counts[1], (int32_t)REGISTER(TIM4 + 0x24), 1 << 16);
        leastaction_status status = machine_tick(&loop, elapsed, counts, &duty);
        drive(duty);
        write(GPIOA, 5, status == LEASTACTION_STATUS_OK);
        REGISTER(IWDG) = 0xaaaa;
    }
}
