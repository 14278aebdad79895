// Torques of a learned machine, and a hook that feeds them forward to the motors of SimpleFOC 2.4 or later.
//
// build.sh puts leastaction.h and the compiled library beside this file, for your model's family and sizes.
#ifndef LEASTACTION_ARDUINO_H
#define LEASTACTION_ARDUINO_H

#include "leastaction.h"

class LeastAction {
  public:
    static constexpr size_t N = LEASTACTION_COORDINATES;

    // Loads a model file, which stays in flash, at a multiple of 4. On failure `leastaction_message(status)` says why, and all torques are refused.
    leastaction_status begin(const uint8_t *file, size_t bytes) {
        return leastaction_load(&model_, sizeof model_, LEASTACTION_ABI, file, bytes, nullptr, nullptr);
    }

    // Torques u, N m (or N), of a motion: inertia, gravity, damping and friction at position q, velocity v and acceleration a.
    leastaction_status torque(const float (&q)[N], const float (&v)[N], const float (&a)[N], float (&u)[N]) const {
        return leastaction_inverse_dynamics(&model_, q, v, a, N, u, nullptr);
    }

    // Feeds the torques of the motion that the motors make forward, one motor for every coordinate: their present angles and velocities, the
    // planned accelerations a (rad/s²; zeros hold against gravity and friction), and the torque constants (N m/A; 0 for a joint without a motor,
    // whose pointer may be null). Call it before `motor.move()`, in a current mode of the torque controller. On failure nothing is fed forward.
    template <class Motor>
    leastaction_status feedForward(Motor *const (&motors)[N], const float (&a)[N], const float (&torque_constant)[N]) const {
        float q[N] = {}, v[N] = {}, u[N] = {};
        for (size_t i = 0; i < N; i++) {
            if (motors[i] == nullptr) continue;
            q[i] = motors[i]->shaft_angle;
            v[i] = motors[i]->shaft_velocity;
        }
        const leastaction_status status = torque(q, v, a, u);
        for (size_t i = 0; i < N; i++) {
            if (motors[i] == nullptr) continue;
            const bool fed = status == LEASTACTION_STATUS_OK && torque_constant[i] > 0;
            motors[i]->feed_forward_current.q = fed ? u[i] / torque_constant[i] : 0;
            motors[i]->feed_forward_current.d = 0;
        }
        return status;
    }

  private:
    leastaction_model model_ = {};
};

#endif
