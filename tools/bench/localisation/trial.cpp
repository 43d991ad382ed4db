#include "tools/bench/localisation/trial.hpp"

#include <algorithm>
#include <ctime>
#include <limits>

namespace curbstone::bench::localisation {
namespace {

constexpr std::int64_t kPause = 50'000;  // us between the last message of a piece and the first of the next

double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

/// The pose with roll and pitch set to 0.
Pose planar(const odometry_t& m) {
  const Pose pose = pose_from_arrays(m.position, m.orientation);
  Pose plane = Pose::Identity();
  plane.translation() = pose.translation();
  plane.linear() = rotation_from_rpy(0, 0, roll_pitch_yaw(pose.linear()).z());
  return plane;
}

}  // namespace

Trial::Trial(const localizer::LocalizerConfig& config, const RecordedDrive& drive, const localise::TrueMapPose* truth)
    : drive_(drive), truth_(truth), node_(config, bus_) {
  bus_.subscribe<map_pose_t>("LOCALIZED_POSE", [this](const map_pose_t& pose) {
    Said said;
    said.utime = pose.utime - late_;
    said.sure = (pose.flags & map_pose_t::LOST) == 0;
    said.ambiguous = (pose.flags & map_pose_t::AMBIGUOUS) != 0;
    const auto true_pose = truth_ != nullptr ? truth_->at(said.utime) : std::nullopt;
    const Pose estimate = pose_from_arrays(pose.map_base_position, pose.map_base_orientation);
    said.error = true_pose ? (estimate.translation() - true_pose->translation()).head<2>().norm()
                           : std::numeric_limits<double>::infinity();
    said.ms = std::exchange(ms_, 0);
    said_.push_back(said);
  });
}

void Trial::play(std::int64_t from, std::int64_t until) {
  if (last_lidar_) take_up(from);
  const auto& messages = drive_.messages();
  for (std::size_t i = drive_.first_at(from); i < messages.size() && time_of(messages[i]) < until; ++i) {
    const double begun = cpu_ms();
    std::visit([this](const auto& m) { on_message(m); }, messages[i]);
    ms_ += cpu_ms() - begun;
    bus_.dispatch();
  }
}

void Trial::take_up(std::int64_t from) {
  late_ = std::max(last_lidar_->utime, last_odometry_->utime) + kPause - from;
  const auto& messages = drive_.messages();
  for (std::size_t i = drive_.first_at(from); i < messages.size(); ++i) {
    const auto* next = std::get_if<lidar_points_t>(&messages[i]);
    if (next == nullptr) continue;
    packets_ = last_lidar_->packet + 1 - next->packet;
    revolutions_ = last_lidar_->revolution + 1 - next->revolution;
    break;
  }
  T_heard_odom_ = planar(*last_odometry_) * planar(drive_.odometry_at(from)).inverse();
}

void Trial::on_message(const lidar_points_t& message) {
  last_lidar_ = message;
  last_lidar_->utime += late_;
  last_lidar_->packet += packets_;
  last_lidar_->revolution += revolutions_;
  node_.on(*last_lidar_);
}

void Trial::on_message(const odometry_t& message) {
  last_odometry_ = message;
  last_odometry_->utime += late_;
  pose_to_arrays(T_heard_odom_ * pose_from_arrays(message.position, message.orientation), last_odometry_->position,
                 last_odometry_->orientation);
  node_.on(*last_odometry_);
}

}  // namespace curbstone::bench::localisation
