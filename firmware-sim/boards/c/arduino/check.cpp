// The hook with motors that have the members of SimpleFOC's FOCMotor (shaft_angle, shaft_velocity, feed_forward_current): what is fed forward are
// the library's torques, bit for bit, and nothing after an error.
#include "LeastAction.h"
#include <cmath>
#include <cstdio>
#include <cstring>

extern "C" const uint8_t machine_model[];
extern "C" const size_t machine_model_bytes;

struct DQCurrent { float d, q; };
struct Motor { float shaft_angle, shaft_velocity; DQCurrent feed_forward_current; };

static int failed = 0;
static void expect(bool holds, const char *what) {
    if (!holds) { std::printf("not: %s\n", what); failed = 1; }
}

int main() {
    Motor first = {0.3f, -1.5f, {9, 9}}, second = {-0.7f, 2.5f, {9, 9}};
    Motor *const motors[2] = {&first, &second};
    const float a[2] = {0.5f, -4}, constants[2] = {0.25f, 0.5f}, none[2] = {0, 0.5f};
    LeastAction machine;
    expect(machine.feedForward(motors, a, constants) != LEASTACTION_STATUS_OK, "without a model it is refused");
    expect(first.feed_forward_current.q == 0 && second.feed_forward_current.q == 0, "nothing is fed forward then");
    expect(machine.begin(machine_model, machine_model_bytes) == LEASTACTION_STATUS_OK, "the model is loaded");
    const float q[2] = {0.3f, -0.7f}, v[2] = {-1.5f, 2.5f};
    float u[2] = {0, 0};
    expect(machine.torque(q, v, a, u) == LEASTACTION_STATUS_OK, "torques");
    expect(machine.feedForward(motors, a, constants) == LEASTACTION_STATUS_OK, "feed forward");
    const float fed[2] = {first.feed_forward_current.q * constants[0], second.feed_forward_current.q * constants[1]};
    expect(std::memcmp(u, fed, sizeof u) == 0 && u[0] != 0 && u[1] != 0, "the torques' bits");
    expect(first.feed_forward_current.d == 0, "no current across");
    expect(machine.feedForward(motors, a, none) == LEASTACTION_STATUS_OK && first.feed_forward_current.q == 0, "no motor, no current");
    Motor *const alone[2] = {nullptr, &second};
    expect(machine.feedForward(alone, a, constants) == LEASTACTION_STATUS_OK, "a joint without a motor");
    first.shaft_angle = NAN;
    expect(machine.feedForward(motors, a, constants) != LEASTACTION_STATUS_OK && second.feed_forward_current.q == 0, "no angle, no current");
    if (!failed) std::printf("the hook feeds the library's torques forward\n");
    return failed;
}
