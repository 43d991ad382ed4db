#pragma once

#include <curbstone/imu_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/wheels_t.hpp>
#include <optional>
#include <vector>

#include "common/bus/node.hpp"
#include "common/bus/single_sender.hpp"
#include "common/resend/message_keeper.hpp"
#include "common/shell/latency.hpp"
#include "common/time/silence_timer.hpp"
#include "services/ekf/filter/rewinding_filter.hpp"
#include "services/ekf/inputs/imu_outlier_filter.hpp"
#include "services/ekf/inputs/map_increment.hpp"
#include "services/ekf/inputs/running_clock.hpp"
#include "services/ekf/inputs/sequencer.hpp"
#include "services/ekf/inputs/shaken_imu.hpp"
#include "services/ekf/inputs/stale_counts.hpp"
#include "services/ekf/inputs/stamp_smoother.hpp"
#include "services/ekf/inputs/stuck_accelerometer.hpp"
#include "services/ekf/mounting/mounting_watch.hpp"
#include "services/ekf/state/state_keeper.hpp"

namespace curbstone::ekf {

/// Subscribes to IMU and WHEELS (with `fuse_map` also MAP_POSE) and publishes ODOMETRY and POSE: one of each for every
/// IMU sample, at its stamp; while there is no IMU, for every wheel sample. Late IMU stamps are straightened
/// (StampSmoother), and after the host's clock was set the stamp is that of the new clock (RunningClock).
///
/// The output is a function of the channels' sequences (Sequencer) as long as none lags by more than its hold; a later
/// sample still counts (RewindingFilter). tick() only detects silence, for the faults, and resends ODOMETRY that a
/// subscriber lost. Latency is in message time: how far the sensors are ahead when an estimate is published. With
/// `state_file` tick() has the belief saved, and a process that replaces a killed one continues from it.
class EkfNode final : public Node {
 public:
  EkfNode(const base::EkfConfig& config, Publisher& publisher);

  void connect(Subscriber& bus) override;
  void tick(std::int64_t now) override;
  void end_drive() override;
  void finish() override { end_drive(); }
  [[nodiscard]] NodeReport report() const override;

  void on(const imu_t& message);
  void on(const wheels_t& message);
  void on(const map_pose_t& message);
  [[nodiscard]] const filter::RewindingFilter& filter() const { return filter_; }

 private:
  struct Input {
    const char* name;
    const char* counter;     // the end of its counters' names
    std::int64_t heard = 0;  // us, newest stamp; 0: none yet
    SilenceTimer silence{};
    SingleSender sender{};
    std::optional<std::int32_t> sequence{};  // of the newest message
    int refused_in_a_row = 0;
  };

  template <class Message>
  [[nodiscard]] bool accept(Input& input, const Message& message);
  void process_due();
  void process(const inputs::Sequencer::Sample& sample);
  void check_mounting(const inputs::Sequencer::Sample& sample);
  [[nodiscard]] std::optional<inputs::Sequencer::Sample> usable_of(const inputs::Sequencer::Sample& sample);
  void publish(const model::Estimate& estimate);
  void count_lost_messages(Input& input, std::int32_t sequence);
  void refuse(Input& input, const char* cause);
  void add_counters(Counters& counters) const;
  void describe_input(const Input& input, std::vector<std::string>& faults) const;
  void describe_devices(std::vector<std::string>& faults) const;
  void describe_odometry(const model::Estimate& last, std::vector<std::string>& faults) const;

  base::EkfConfig config_;
  Publisher& publisher_;
  MessageKeeper sent_;  // ODOMETRY
  inputs::RunningClock clock_;
  inputs::StampSmoother imu_stamps_;
  inputs::Sequencer sequencer_;
  inputs::ImuOutlierFilter imu_outliers_;
  inputs::StaleCounts stale_counts_;
  inputs::MapIncrements increments_;
  inputs::StuckAccelerometer accelerometer_;
  inputs::ShakenImu shaken_imu_;
  filter::RewindingFilter filter_;
  mounting::MountingWatch mounting_;
  Counters counters_;
  LatencyWindow latency_;
  Input imu_{.name = "IMU", .counter = "imu"};
  Input wheels_{.name = "WHEELS", .counter = "wheels"};
  std::int32_t imu_status_ = 0;
  wheels_t last_wheels_{};
  std::optional<model::Estimate> last_;
  SilenceTimer start_;           // never hears anything: how long this process has run
  std::int64_t state_kept_ = 0;  // us
  bool is_over_ = false;         // the drive is: nobody is silent
  std::optional<state::StateKeeper> state_keeper_;
  std::vector<model::Estimate> estimates_;
};

}  // namespace curbstone::ekf
