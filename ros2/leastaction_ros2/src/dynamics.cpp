#include "leastaction_ros2/dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

namespace leastaction_ros2 {

namespace {

/// Largest file that is read: the library's own are a few kilobytes.
constexpr std::streamoff LARGEST_FILE = 64 << 20;

/// Throws if a call of the library failed, with the file that it was about.
void check(leastaction_status status, const leastaction_error & error, const std::string & path) {
    if (status != LEASTACTION_STATUS_OK) throw std::runtime_error("'" + path + "': " + words(error));
}

}  // namespace

std::string words(const leastaction_error & error) {
    std::string text = leastaction_message(error.status);
    text += " (status " + std::to_string(error.status);
    if (error.what != nullptr) text += ", " + std::string(error.what, error.what_bytes);
    std::size_t count = std::size(error.numbers);
    while (count > 0 && error.numbers[count - 1] == 0) count--;
    for (std::size_t i = 0; i < count; i++) text += (i == 0 ? ": " : ", ") + std::to_string(error.numbers[i]);
    return text + ")";
}

File::File(const std::string & path) {
    std::ifstream stream(path, std::ios::binary | std::ios::ate);
    const std::streamoff size = stream ? std::streamoff(stream.tellg()) : -1;
    if (size < 0) throw std::runtime_error("'" + path + "' cannot be opened");
    if (size > LARGEST_FILE) throw std::runtime_error("'" + path + "' is no model or plan: it has more than 64 MiB");
    size_ = static_cast<std::size_t>(size);
    // One word more: an empty file has an address, too.
    words_.resize(size_ / sizeof(std::uint32_t) + 1);
    stream.seekg(0);
    if (!stream.read(reinterpret_cast<char *>(words_.data()), size)) throw std::runtime_error("'" + path + "' cannot be read");
}

Model::Model(const std::string & path, const std::string & name) : file_(path) {
    leastaction_error error{};
    const char * chosen = name.empty() ? nullptr : name.c_str();
    const auto status = leastaction_load(&model_, sizeof model_, LEASTACTION_ABI, file_.data(), file_.size(), chosen, &error);
    check(status, error, path);
}

leastaction_status Model::inverse_dynamics(const Vector & q, const Vector & v, const Vector & a, Vector & u) const noexcept {
    return leastaction_inverse_dynamics(&model_, q.data(), v.data(), a.data(), N, u.data(), nullptr);
}

leastaction_status Model::gravity_torque(const Vector & q, Vector & u) const noexcept {
    return leastaction_gravity_torque(&model_, q.data(), N, u.data(), nullptr);
}

leastaction_status Model::mass_matrix(const Vector & q, Matrix & mass) const noexcept {
    return leastaction_mass_matrix(&model_, q.data(), N, mass.data(), nullptr);
}

Drives Model::drives() const {
    // Commands that are held make the same force at any step, whatever the delay: of no command the offset, of one unit also the gain.
    const float h = 1e-3f;
    Vector none{}, unit, end;
    unit.fill(1.0f);
    Drives drives{};
    leastaction_error error{};
    check(leastaction_actuate(&model_, h, none.data(), none.data(), N, drives.offset.data(), end.data(), &error), error, "actuator");
    check(leastaction_actuate(&model_, h, unit.data(), unit.data(), N, drives.gain.data(), end.data(), &error), error, "actuator");
    for (std::size_t i = 0; i < N; i++) {
        drives.gain[i] -= drives.offset[i];
        if (!(drives.gain[i] > 0.0f)) {
            throw std::runtime_error("the model's drive of coordinate " + std::to_string(i) + " has no positive gain");
        }
    }
    return drives;
}

Plan::Plan(const std::string & path, const Model & model) : file_(path) {
    leastaction_error error{};
    const auto status =
        leastaction_plan_load(&plan_, sizeof plan_, LEASTACTION_ABI, file_.data(), file_.size(), model.get(), &error);
    check(status, error, path);
}

leastaction_status Plan::command_at(float t, const Vector & q, const Vector & v, Vector & u) const noexcept {
    return leastaction_plan_command_at(&plan_, t, q.data(), v.data(), N, u.data(), nullptr);
}

leastaction_status Plan::turns(const Vector & q, const std::array<std::uint8_t, N> & forgetful, Vector & turns) const noexcept {
    return leastaction_plan_turns(&plan_, q.data(), forgetful.data(), N, turns.data(), nullptr);
}

Vector Plan::largest_commands() const {
    std::array<std::uint8_t, N> driven{};
    Vector least{}, most{}, largest{};
    leastaction_error error{};
    check(leastaction_plan_limits(&plan_, N, driven.data(), least.data(), most.data(), &error), error, "plan");
    for (std::size_t i = 0; i < N; i++) largest[i] = std::max(std::abs(least[i]), std::abs(most[i]));
    return largest;
}

}  // namespace leastaction_ros2
