/* A learned machine on an ESP32-C3 under ESP-IDF: a tick of a hardware timer, two magnetic encoders, a drive by PWM and direction, a watchdog. */
#include "machine.h"

#include "driver/gpio.h"
#include "driver/gptimer.h"
#include "driver/i2c_master.h"
#include "driver/ledc.h"
#include "esp_log.h"
#include "esp_task_wdt.h"
#include "freertos/FreeRTOS.h"
#include "freertos/task.h"

/* CHANGE 5: the pins of encoders and drive; the encoders are an AS5600L and an AS5600 on one bus. */
enum { SDA = 4, SCL = 5, PWM = 6, DIRECTION = 7 };
static const uint8_t addresses[MACHINE_N] = {0x40, 0x36};
enum { TURN = 4096, TOP = 1 << 11 };

static machine loop;
static i2c_master_dev_handle_t encoders[MACHINE_N];
static TaskHandle_t task;

static bool IRAM_ATTR alarmed(gptimer_handle_t timer, const gptimer_alarm_event_data_t *event, void *context) {
    BaseType_t woken = pdFALSE;
    vTaskNotifyGiveFromISR(task, &woken);
    return woken == pdTRUE;
}

/* All counts of an encoder, which turned by less than half a turn since the last reading. */
static bool read(i2c_master_dev_handle_t encoder, int32_t *total) {
    const uint8_t angle = 0x0e;
    uint8_t bytes[2];
    if (i2c_master_transmit_receive(encoder, &angle, 1, bytes, 2, 2) != ESP_OK) return false;
    *total = machine_count(*total, (bytes[0] & 0xf) << 8 | bytes[1], TURN);
    return true;
}

static void drive(float duty) {
    gpio_set_level(DIRECTION, duty < 0);
    ledc_set_duty(LEDC_LOW_SPEED_MODE, LEDC_CHANNEL_0, (uint32_t)((duty < 0 ? -duty : duty) * TOP));
    ledc_update_duty(LEDC_LOW_SPEED_MODE, LEDC_CHANNEL_0);
}

static void begin_devices(void) {
    i2c_master_bus_handle_t bus;
    const i2c_master_bus_config_t bus_config = {.i2c_port = 0, .sda_io_num = SDA, .scl_io_num = SCL, .clk_source = I2C_CLK_SRC_DEFAULT, .glitch_ignore_cnt = 7};
    ESP_ERROR_CHECK(i2c_new_master_bus(&bus_config, &bus));
    for (int i = 0; i < MACHINE_N; i++) {
        const i2c_device_config_t device = {.device_address = addresses[i], .scl_speed_hz = 400000};
        ESP_ERROR_CHECK(i2c_master_bus_add_device(bus, &device, &encoders[i]));
    }
    ESP_ERROR_CHECK(gpio_set_direction(DIRECTION, GPIO_MODE_OUTPUT));
    const ledc_timer_config_t clock = {.speed_mode = LEDC_LOW_SPEED_MODE, .duty_resolution = LEDC_TIMER_11_BIT, .timer_num = LEDC_TIMER_0, .freq_hz = 20000, .clk_cfg = LEDC_AUTO_CLK};
    ESP_ERROR_CHECK(ledc_timer_config(&clock));
    const ledc_channel_config_t channel = {.gpio_num = PWM, .speed_mode = LEDC_LOW_SPEED_MODE, .channel = LEDC_CHANNEL_0, .timer_sel = LEDC_TIMER_0};
    ESP_ERROR_CHECK(ledc_channel_config(&channel));
}

static void begin_ticks(float period) {
    gptimer_handle_t timer;
    const gptimer_config_t config = {.clk_src = GPTIMER_CLK_SRC_DEFAULT, .direction = GPTIMER_COUNT_UP, .resolution_hz = 1000000};
    const gptimer_alarm_config_t alarm = {.alarm_count = (uint64_t)(period * 1e6f + 0.5f), .flags.auto_reload_on_alarm = true};
    const gptimer_event_callbacks_t callbacks = {.on_alarm = alarmed};
    ESP_ERROR_CHECK(gptimer_new_timer(&config, &timer));
    ESP_ERROR_CHECK(gptimer_set_alarm_action(timer, &alarm));
    ESP_ERROR_CHECK(gptimer_register_event_callbacks(timer, &callbacks, NULL));
    ESP_ERROR_CHECK(gptimer_enable(timer));
    ESP_ERROR_CHECK(gptimer_start(timer));
}

void app_main(void) {
    int32_t counts[MACHINE_N] = {0};
    uint32_t elapsed = 0;
    task = xTaskGetCurrentTaskHandle();
    vTaskPrioritySet(NULL, configMAX_PRIORITIES - 1);
    begin_devices();
    /* A model or a plan that is refused never moves the machine. */
    const leastaction_status status = machine_begin(&loop);
    if (status != LEASTACTION_STATUS_OK) {
        ESP_LOGE("machine", "%s", leastaction_message(status));
        return;
    }
    ESP_ERROR_CHECK(esp_task_wdt_add(NULL));
    begin_ticks(machine_period(&loop));
    for (;;) {
        float duty = 0;
        elapsed += ulTaskNotifyTake(pdTRUE, portMAX_DELAY);
        bool answered = true;
        for (int i = 0; i < MACHINE_N; i++) answered = read(encoders[i], &counts[i]) && answered;
        /* A tick whose encoders do not answer is left out. */
        if (answered) {
            machine_tick(&loop, elapsed, counts, &duty);
            elapsed = 0;
        }
        drive(duty);
        esp_task_wdt_reset();
    }
}
