/// \file
/// The C library of the built family and size, as C++ classes: a model and a plan that own the bytes of their files.
#ifndef LEASTACTION_ROS2__DYNAMICS_HPP_
#define LEASTACTION_ROS2__DYNAMICS_HPP_

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "leastaction.h"

namespace leastaction_ros2 {

/// Number of coordinates that the library was built for: joints of the robot.
inline constexpr std::size_t N = LEASTACTION_COORDINATES;

/// A number for each coordinate, in the library's precision.
using Vector = std::array<float, N>;

/// The inertia matrix, row by row.
using Matrix = std::array<float, N * N>;

/// Bytes of a file at a multiple of 4, as the library reads them.
class File {
public:
    /// Reads a file. Throws std::runtime_error if it cannot be read, or has more than 64 MiB.
    explicit File(const std::string & path);

    const std::uint8_t * data() const noexcept { return reinterpret_cast<const std::uint8_t *>(words_.data()); }
    std::size_t size() const noexcept { return size_; }

private:
    std::vector<std::uint32_t> words_;
    std::size_t size_ = 0;
};

/// Gain g > 0 and offset o of every drive: a command u makes the force g u + o, N or N m. Without an actuator in the file, g = 1 and o = 0.
struct Drives {
    Vector gain;
    Vector offset;
};

/// A model file, loaded. Functions are those of the C library: they allocate nothing, throw nothing, and may be called from any thread.
class Model {
public:
    /// Loads a model file. `name` chooses the tree or graph of a file that holds several; other families ignore it.
    /// Throws std::runtime_error if the file cannot be read or is refused.
    explicit Model(const std::string & path, const std::string & name = "");
    Model(const Model &) = delete;
    Model & operator=(const Model &) = delete;

    /// u = M a + h, N or N m: the force that gives the acceleration a, friction included.
    leastaction_status inverse_dynamics(const Vector & q, const Vector & v, const Vector & a, Vector & u) const noexcept;

    /// u = V_q, N or N m: the force that holds the robot at rest.
    leastaction_status gravity_torque(const Vector & q, Vector & u) const noexcept;

    /// M(q).
    leastaction_status mass_matrix(const Vector & q, Matrix & mass) const noexcept;

    /// Gains and offsets of the file's actuator. Throws std::runtime_error if one has no positive gain.
    Drives drives() const;

    /// The library's model, for functions that this class does not have.
    const leastaction_model * get() const noexcept { return &model_; }

private:
    File file_;
    leastaction_model model_{};
};

/// A plan file of `leastaction plan`, loaded for its model.
class Plan {
public:
    /// Loads a plan. Throws std::runtime_error if the file cannot be read, is refused, or was made for another model.
    Plan(const std::string & path, const Model & model);
    Plan(const Plan &) = delete;
    Plan & operator=(const Plan &) = delete;

    /// u = ū − K (x − x̄) within the plan's limits, t seconds after the first command: 0 where nothing drives.
    leastaction_status command_at(float t, const Vector & q, const Vector & v, Vector & u) const noexcept;

    /// Whole turns, rad, by which the first measured position is off the plan's start, for coordinates that are marked.
    leastaction_status turns(const Vector & q, const std::array<std::uint8_t, N> & forgetful, Vector & turns) const noexcept;

    /// The largest command of every coordinate by absolute value, N or N m: 0 where nothing drives.
    Vector largest_commands() const;

private:
    File file_;
    leastaction_plan plan_{};
};

/// The library's words for an error: its message, subject and numbers.
std::string words(const leastaction_error & error);

}  // namespace leastaction_ros2

#endif  // LEASTACTION_ROS2__DYNAMICS_HPP_
