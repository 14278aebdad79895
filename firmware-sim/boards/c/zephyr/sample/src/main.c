/* A learned machine under Zephyr: a tick of the kernel's timer, two incremental encoders, a drive by PWM and direction, a watchdog. */
#include "machine.h"

#include <zephyr/drivers/gpio.h>
#include <zephyr/drivers/pwm.h>
#include <zephyr/drivers/sensor.h>
#include <zephyr/drivers/watchdog.h>
#include <zephyr/kernel.h>

static const struct device *const encoders[MACHINE_N] = {DEVICE_DT_GET(DT_ALIAS(cart_encoder)), DEVICE_DT_GET(DT_ALIAS(pole_encoder))};
static const struct pwm_dt_spec pwm = PWM_DT_SPEC_GET(DT_PATH(zephyr_user));
static const struct gpio_dt_spec direction = GPIO_DT_SPEC_GET(DT_PATH(zephyr_user), direction_gpios);
static const struct device *const watchdog = DEVICE_DT_GET(DT_ALIAS(watchdog0));
/* The watchdog resets the chip, which stops the drive, after this many periods without a tick. */
static const float patience = 5;
/* Counts of a turn in the overlay. */
static const int32_t turn = 4096;

static machine loop;
K_TIMER_DEFINE(ticks, NULL, NULL);

/* All counts of an encoder, which the driver gives as an angle within a turn. */
static bool read(const struct device *encoder, int32_t *total) {
    struct sensor_value angle;
    if (sensor_sample_fetch(encoder) || sensor_channel_get(encoder, SENSOR_CHAN_ROTATION, &angle)) return false;
    const float degrees = (float)angle.val1 + (float)angle.val2 * 1e-6f;
    *total = machine_count(*total, (int32_t)(degrees * (float)turn / 360 + 0.5f), turn);
    return true;
}

static void drive(float duty) {
    gpio_pin_set_dt(&direction, duty < 0);
    pwm_set_pulse_dt(&pwm, (uint32_t)((duty < 0 ? -duty : duty) * (float)pwm.period));
}

/* Nothing may be missing before the machine is moved. */
static bool begin(int *channel) {
    bool ready = device_is_ready(watchdog) && pwm_is_ready_dt(&pwm) && gpio_is_ready_dt(&direction);
    for (int i = 0; i < MACHINE_N; i++) ready = ready && device_is_ready(encoders[i]);
    if (!ready || gpio_pin_configure_dt(&direction, GPIO_OUTPUT_INACTIVE)) return false;
    const leastaction_status status = machine_begin(&loop);
    if (status != LEASTACTION_STATUS_OK) {
        printk("%s\n", leastaction_message(status));
        return false;
    }
    const struct wdt_timeout_cfg timeout = {.window = {.max = (uint32_t)(patience * machine_period(&loop) * 1e3f)}, .flags = WDT_FLAG_RESET_SOC};
    *channel = wdt_install_timeout(watchdog, &timeout);
    return *channel >= 0 && wdt_setup(watchdog, 0) == 0;
}

int main(void) {
    int32_t counts[MACHINE_N] = {0};
    uint32_t elapsed = 0;
    int channel;
    if (!begin(&channel)) return 1;
    const k_timeout_t period = K_USEC((uint32_t)(machine_period(&loop) * 1e6f + 0.5f));
    k_timer_start(&ticks, period, period);
    for (;;) {
        float duty = 0;
        elapsed += k_timer_status_sync(&ticks);
        /* A tick whose encoders do not answer is left out. */
        bool answered = true;
        for (int i = 0; i < MACHINE_N; i++) answered = read(encoders[i], &counts[i]) && answered;
        if (answered) {
            machine_tick(&loop, elapsed, counts, &duty);
            elapsed = 0;
        }
        drive(duty);
        wdt_feed(watchdog, channel);
    }
}
