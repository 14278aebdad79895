/// \file
/// Fields of trajectory_msgs/msg/JointTrajectoryPoint that the package uses. Never installed.
#ifndef STATED__TRAJECTORY_MSGS__MSG__JOINT_TRAJECTORY_POINT_HPP_
#define STATED__TRAJECTORY_MSGS__MSG__JOINT_TRAJECTORY_POINT_HPP_

#include <vector>

namespace trajectory_msgs::msg {

struct JointTrajectoryPoint {
    std::vector<double> positions, velocities, accelerations, effort;
};

}  // namespace trajectory_msgs::msg

#endif  // STATED__TRAJECTORY_MSGS__MSG__JOINT_TRAJECTORY_POINT_HPP_
