#include "tools/bench/faults/fault_rows.hpp"

#include <fmt/format.h>

namespace curbstone::bench::faults {

namespace {

constexpr double kMidDrive = 8;  // s

Fault nothing() {
  return {"none", [](StackDrive& drive) {
            drive.go_on_until(kMidDrive);
            drive.fault_is_over();
          }};
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
            drive.kill_command(one);
            drive.kill_command(other);
          }};
}

Fault each_killed_in_turn() {
  constexpr double kEach = 3;  // s
  return {"kill -9 one after the other, every 3 s",
          [](StackDrive& drive) {
            double at = kEach;
            for (std::size_t turn = 0; !drive.over() && at < 60 - kEach; ++turn, at += kEach) {
              drive.go_on_until(at);
              if (!drive.over()) drive.kill_command(drive.commands()[turn % drive.commands().size()]);
            }
          },
          60};
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
            drive.fault_is_over();  // it begins now: so the way back has the silence in it
          },
          18, fmt::format("--fault {}-silent:{}-{}", sensor, kMidDrive, kMidDrive + 2)};
}

}  // namespace

std::vector<Fault> all_faults() {
  std::vector<Fault> faults = {nothing()};
  for (const char* command :
       {"lidar", "imu", "encoder", "ekf", "mapper", "tensor_voting:1", "semantic_map", "recorder", "deputy"})
    faults.push_back(killed(command));
  faults.push_back(both_killed("ekf", "mapper"));
  faults.push_back(both_killed("tensor_voting:1", "semantic_map"));
  faults.push_back(power_lost());
  for (const char* command : {"ekf", "mapper", "tensor_voting:1", "semantic_map"}) faults.push_back(frozen(command));
  faults.push_back(busy_cpu());
  for (const char* sensor : {"lidar", "imu", "wheels"}) faults.push_back(silent(sensor));
  faults.push_back(each_killed_in_turn());
  return faults;
}

}  // namespace curbstone::bench::faults
