#include "tools/bench/faults/fault_rows.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace curbstone::bench::faults {

namespace {

constexpr double kMidDrive = 8;    // s
constexpr double kLongDrive = 60;  // s
constexpr std::size_t kPairDrives = 3;
constexpr std::array kCommands = {"lidar",           "imu",          "encoder", "ekf", "mapper",
                                  "tensor_voting:1", "semantic_map", "recorder"};

/// Nobody has what was measured meanwhile, or nothing was.
Excuse all_excused(std::string why) {
  return {Excuse::Covers::kAll, std::move(why)};
}
Excuse time_excused(std::string why) {
  return {Excuse::Covers::kTime, std::move(why)};
}

Fault nothing(const std::string& name, double seconds) {
  return {name,
          [](StackDrive& drive) {
            drive.go_on_until(kMidDrive);
            drive.fault_is_over();
          },
          seconds};
}

Fault with(Excuse excuse, Fault fault) {
  fault.excuse = std::move(excuse);
  return fault;
}

Fault killed(const std::string& command) {
  return {"kill -9 " + command, [command](StackDrive& drive) {
            drive.go_on_until(kMidDrive);
            drive.kill_command(command);
          }};
}

Fault both_killed(const std::string& one, const std::string& other) {
  return {fmt::format("kill -9 {} and {}", one, other), [one, other](StackDrive& drive) {
            drive.go_on_until(kMidDrive);
            drive.kill_commands(one, other);
          }};
}

/// Injects one fault after the other until the drive is nearly over.
void every(StackDrive& drive, double seconds, const std::function<void(std::size_t turn)>& deed) {
  double at = seconds;
  for (std::size_t turn = 0; !drive.over() && at < kLongDrive - seconds; ++turn, at += seconds) {
    drive.go_on_until(at);
    if (!drive.over()) deed(turn);
  }
}

std::vector<std::pair<std::string, std::string>> all_pairs() {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (std::size_t i = 0; i < kCommands.size(); ++i) {
    for (std::size_t k = i + 1; k < kCommands.size(); ++k) pairs.emplace_back(kCommands[i], kCommands[k]);
  }
  return pairs;
}

/// All 28 pairs need three drives.
Fault pairs_killed(std::size_t part) {
  return {fmt::format("kill -9 of any two at once, every 5 s, part {} of {} of the pairs", part + 1, kPairDrives),
          [part](StackDrive& drive) {
            const auto pairs = all_pairs();
            every(drive, 5, [&](std::size_t turn) {
              const std::size_t pair = part + turn * kPairDrives;
              if (pair < pairs.size()) drive.kill_commands(pairs[pair].first, pairs[pair].second);
            });
          },
          kLongDrive};
}

Fault killed_again_and_again(const std::string& command) {
  return {fmt::format("kill -9 {} every 3 s", command),
          [command](StackDrive& drive) { every(drive, 3, [&](std::size_t) { drive.kill_command(command); }); },
          kLongDrive};
}

Fault each_killed_in_turn() {
  return {"kill -9 one after the other, every 3 s",
          [](StackDrive& drive) {
            every(drive, 3,
                  [&](std::size_t turn) { drive.kill_command(drive.commands()[turn % drive.commands().size()]); });
          },
          kLongDrive};
}

Fault disk_full() {
  return {.name = "disk full for 5 s",
          .happen =
              [](StackDrive& drive) {
                drive.go_on_until(kMidDrive);
                drive.fill_disk(5);
              },
          .disk_mb = 600};
}

Fault interface_down() {
  return {"loopback interface down for 2 s", [](StackDrive& drive) {
            drive.go_on_until(kMidDrive);
            drive.take_interface_down(2);
          }};
}

Fault power_lost() {
  return {"power loss: all at once", [](StackDrive& drive) {
            drive.go_on_until(kMidDrive);
            drive.lose_power();
          }};
}

Fault frozen(const std::string& command) {
  return {"SIGSTOP of " + command + " for 5 s", [command](StackDrive& drive) {
            drive.go_on_until(kMidDrive);
            drive.freeze(command, 5);
          }};
}

/// The time until it is back includes that until the deputy takes it for hanging.
Fault hanging(const std::string& command) {
  return {"SIGSTOP of " + command + " for ever",
          [command](StackDrive& drive) {
            drive.go_on_until(kMidDrive);
            drive.hang(command);
          },
          30};
}

Fault busy_cpu() {
  return {"two CPU hogs for 8 s", [](StackDrive& drive) {
            drive.go_on_until(5);
            drive.keep_cpu_busy(2, 8);
          }};
}

Fault silent(const std::string& sensor) {
  return {sensor + " silent for 2 s",
          [](StackDrive& drive) {
            drive.go_on_until(kMidDrive);
            drive.fault_is_over();  // the fault begins now, so the recovery time includes the silence
          },
          18, fmt::format("--fault {}-silent:{}-{}", sensor, kMidDrive, kMidDrive + 2)};
}

/// As a dip of the power at the sensors' hub.
Fault all_silent() {
  std::string options;
  for (const char* sensor : {"lidar", "imu", "wheels"})
    options += fmt::format("--fault {}-silent:{}-{} ", sensor, kMidDrive, kMidDrive + 4);
  return {"all sensors silent for 4 s",
          [](StackDrive& drive) {
            drive.go_on_until(kMidDrive);
            drive.fault_is_over();
          },
          18, options};
}

}  // namespace

std::vector<Fault> all_faults() {
  std::vector<Fault> faults = {nothing("none", Fault{}.seconds), nothing("none, 60 s", kLongDrive)};
  for (const char* command : kCommands) faults.push_back(killed(command));
  const Excuse lidar_too = all_excused("the LiDAR's driver dies as well, and with it what it kept");
  faults.push_back(killed("deputy"));
  faults.push_back(both_killed("ekf", "mapper"));
  faults.push_back(both_killed("tensor_voting:1", "semantic_map"));
  faults.push_back(with(lidar_too, power_lost()));
  const Excuse lidar_frozen = all_excused("the kernel's buffer does not hold 5 s of packets");
  faults.push_back(with(lidar_frozen, frozen("lidar")));
  for (const char* command : {"ekf", "mapper", "tensor_voting:1", "semantic_map", "recorder"})
    faults.push_back(frozen(command));
  for (const char* command : {"ekf", "mapper"})
    faults.push_back(with(time_excused("it takes 7 s to be taken for hanging"), hanging(command)));
  faults.push_back(with(lidar_frozen, hanging("lidar")));
  faults.push_back(busy_cpu());
  const Excuse not_measured = all_excused("nothing is measured while the sensor is silent");
  faults.push_back(with(not_measured, silent("lidar")));
  const Excuse other_sensor = time_excused("the sensor is silent for 2 s; odometry goes on by the other one");
  for (const char* sensor : {"imu", "wheels"}) faults.push_back(with(other_sensor, silent(sensor)));
  faults.push_back(with(not_measured, all_silent()));
  faults.push_back(with(time_excused("the disk is tried again every 2 s"), disk_full()));
  faults.push_back(with(all_excused("the interface carries the LiDAR's packets too"), interface_down()));
  faults.push_back(each_killed_in_turn());
  for (std::size_t part = 0; part < kPairDrives; ++part) faults.push_back(pairs_killed(part));
  for (const char* command : kCommands) faults.push_back(killed_again_and_again(command));
  return faults;
}

}  // namespace curbstone::bench::faults
