#include "services/mapper/mounting/mount_yaw.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace curbstone::mapper::mounting {
namespace {

constexpr std::size_t kScanOffset = 2;  // scans: one during which it turns agrees neither with the one before nor after
constexpr int kMinStillScans = 3;       // still scans in a row: where a swing turns back, one or two look so
constexpr double kMaxResidualRatio = 0.9;       // of the residual without a turn, at most
constexpr std::int64_t kMaxPause = 300'000;     // us
constexpr std::int64_t kPatience = 500'000;     // us until it must be still
constexpr double kUsualGrowth = 1.01;           // of the usual residual, a scan
constexpr std::int64_t kCreepSpan = 1'000'000;  // us: a turn is gradual if before it,
constexpr double kCreep = 3 * MountYaw::kTurn;  // it already turned by this much
constexpr std::int64_t kShakeSpan = 3'000'000;  // us: kShakeTurns turns within it are a shake,
constexpr std::size_t kShakeTurns = 4;
constexpr std::int64_t kMinQuietTime = 2'000'000;  // us in which it is still: it shakes no more

double in_degrees(double rad) {
  return rad * 180 / std::numbers::pi;
}

bool is_turn(const AzimuthProfile::Turn& turn) {
  return std::abs(turn.angle) > MountYaw::kTurn && turn.residual < kMaxResidualRatio * turn.residual_at_zero;
}

}  // namespace

MountYaw::Result MountYaw::add(const Observation& look) {
  if (look.utime <= utime_ || look.utime - utime_ > kMaxPause) interrupt();
  utime_ = look.utime;
  const UprightPoints upright(*look.points, lidar_);
  earlier_.push_back({look.T_odom_base, AzimuthProfile(upright, Pose::Identity())});
  if (earlier_.size() <= kScanOffset) return as_before();
  Earlier earlier = std::move(earlier_.front());
  earlier_.pop_front();
  const auto turn = turn_since(earlier, upright, look);
  if (!turn) {
    interrupt();
    return as_before();
  }
  const Comparison scan = note(*turn);
  switch (state_) {
    case State::kFirm:
      if (scan.turns && !scan.creeps) return begin_to_doubt(std::move(earlier));
      break;
    case State::kInDoubt:
      if (still_ >= kMinStillScans) return end_doubt(upright, look);
      if (utime_ - unsure_since_ > kPatience) return give_up(look.turn_confirmed && !scan.creeps);
      break;
    case State::kOdometry:
      if (scan.still) return settle();
      break;
    case State::kShakes:
      if (utime_ - still_since_ > kMinQuietTime) return settle();
      break;
  }
  return as_before();
}

MountYaw::Result MountYaw::skip(std::int64_t utime) {
  interrupt();
  utime_ = utime;
  if (shakes() && std::abs(utime_ - turning_) > kUnobserved) return settle();
  return as_before();
}

/// The state stays, and with it whether scans are used.
MountYaw::Result MountYaw::as_before() const {
  return state_ == State::kInDoubt || state_ == State::kShakes ? Result::kUncertain : Result::kStable;
}

MountYaw::Comparison MountYaw::note(const AzimuthProfile::Turn& turn) {
  const Comparison scan{is_turn(turn), std::abs(turn.angle) < 0.5 * kTurn, creep() > kCreep};
  creeping_.emplace_back(utime_, std::clamp(turn.angle / kScanOffset, -kTurn, kTurn));  // a leap is no creep
  if (scan.turns) turning_ = utime_;
  if (scan.still && !shakes()) usual_ = usual_ > 0 ? std::min(turn.residual, kUsualGrowth * usual_) : turn.residual;
  still_ = scan.still ? still_ + 1 : 0;
  if (still_ <= 1) still_since_ = utime_;
  return scan;
}

/// rad, the turn of the last second, without leaps.
double MountYaw::creep() {
  while (!creeping_.empty() && std::abs(utime_ - creeping_.front().first) > kCreepSpan) creeping_.pop_front();
  double sum = 0;
  for (const auto& [utime, angle] : creeping_) sum += angle;
  return std::abs(sum);
}

MountYaw::Result MountYaw::begin_to_doubt(Earlier before) {
  state_ = State::kInDoubt;
  before_ = std::move(before);
  unsure_since_ = utime_;
  return Result::kUncertain;
}

/// The LiDAR is still again: what counts is how far it has turned since before.
MountYaw::Result MountYaw::end_doubt(const UprightPoints& upright, const Observation& look) {
  state_ = State::kFirm;
  const auto since = turn_since(*std::exchange(before_, {}), upright, look);
  if (!since || !is_turn(*since)) return Result::kStable;
  while (!turns_.empty() && std::abs(utime_ - turns_.front()) > kShakeSpan) turns_.pop_front();
  if (turns_.empty()) quiet_yaw_ = yaw_;
  turns_.push_back(utime_);
  if (turns_.size() >= kShakeTurns) return begin_to_shake();
  counters_.add("faults.lidar.turned_in_mount");
  if (turned_ == 0 || utime_ - turned_ > kReportedFor) largest_ = 0;
  turned_ = utime_;
  creeping_.clear();
  yaw_ -= since->angle;  // what stands still turns the other way
  largest_ = std::max({largest_, std::abs(yaw_), std::abs(since->angle)});
  earlier_.clear();
  return Result::kTurned;
}

/// It does not come to rest: by wheels and gyro too, then it shakes; else odometry may be what turns.
MountYaw::Result MountYaw::give_up(bool turn_confirmed) {
  interrupt();
  if (turn_confirmed) return begin_to_shake();
  state_ = State::kOdometry;
  return Result::kStable;
}

MountYaw::Result MountYaw::begin_to_shake() {
  counters_.add("faults.lidar.shakes");
  state_ = State::kShakes;
  shook_ = turning_ = utime_;
  if (!turns_.empty()) yaw_ = quiet_yaw_;
  turns_.clear();
  earlier_.clear();
  return Result::kUncertain;
}

MountYaw::Result MountYaw::settle() {
  state_ = State::kFirm;
  return Result::kStable;
}

std::optional<AzimuthProfile::Turn> MountYaw::turn_since(const Earlier& earlier, const UprightPoints& upright,
                                                         const Observation& look) const {
  const AzimuthProfile there(upright, earlier.T_odom_base.inverse() * look.T_odom_base);
  return there.turn_since(earlier.profile, shakes() ? 0 : usual_);
}

/// Breaks the sequence, and ends a doubt, as nothing will resolve it.
void MountYaw::interrupt() {
  if (state_ == State::kInDoubt) state_ = State::kFirm;
  earlier_.clear();
  before_.reset();
  usual_ = 0;
  still_ = 0;
}

void MountYaw::add_faults(std::vector<std::string>& faults) const {
  const auto seconds_ago = [&](std::int64_t since) { return static_cast<double>(utime_ - since) * 1e-6; };
  if (shakes()) {
    faults.emplace_back(
        "LiDAR: it shakes in its mount, by a degree or more: nothing is mapped until it is still. Tighten its mount");
  } else if (shook_ != 0 && utime_ - shook_ < kReportedFor) {
    faults.push_back(fmt::format(
        "LiDAR: it shook in its mount, {:.0f} s ago: tighten its mount. The map has a gap there", seconds_ago(shook_)));
  }
  const bool is_turned = std::abs(yaw_) > kTurn;
  if (turned_ == 0 || (!is_turned && utime_ - turned_ > kReportedFor)) return;
  faults.push_back(fmt::format(
      "LiDAR: it turned by {:.1f} deg in its mount, {:.0f} s ago ({} times in all), and looks {:.1f} deg to "
      "the {} of where vehicle.lidar says: tighten its mount. The map follows it",
      in_degrees(largest_), seconds_ago(turned_), counters_["faults.lidar.turned_in_mount"], in_degrees(std::abs(yaw_)),
      yaw_ > 0 ? "left" : "right"));
}

}  // namespace curbstone::mapper::mounting
