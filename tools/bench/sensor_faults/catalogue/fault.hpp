#pragma once

#include <cstdint>
#include <curbstone/imu_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/wheels_t.hpp>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace curbstone::bench::sensor_faults::catalogue {

/// Changes a message and returns whether it is sent at all. `t`: s since the first message of the drive, by the time at
/// which it was recorded.
template <class Message>
using Change = std::function<bool(double t, Message& message)>;

/// What a fault does to the messages of a replay. An empty function leaves the sensor's messages as they are.
/// `second_`: makes of each message that of a second sender, which follows on the same channel.
struct Changes {
  Change<lidar_points_t> lidar{};
  Change<imu_t> imu{};
  Change<wheels_t> wheels{};
  Change<lidar_points_t> second_lidar{};
  Change<imu_t> second_imu{};
  Change<wheels_t> second_wheels{};
};

constexpr double kOnTheWay = 15.0;  ///< s: the vehicle drives by then, and all that is learned at the start is learned
constexpr double kFromTheBeginning = 0.0;  ///< s: it is mounted, wired or configured wrongly

/// A fault of a sensor, of its mounting or of what is around the vehicle. Or a drive in which nothing is wrong, so that
/// all that is said of it is a false alarm.
struct Fault {
  std::string sensor;  ///< "wheels", "IMU", "LiDAR", "host clock", "bus", "surroundings", "vehicle file", "drive"
  std::string name;    ///< a few words, unique
  std::string words;   ///< what happens, in a line
  double from = 0;     ///< s of the drive
  /// The changes, with their state and random numbers as at the beginning: each call gives the same.
  std::function<Changes()> make = [] { return Changes{}; };
  std::vector<std::string>
      settings{};                 ///< SECTION.KEY=VALUE: what the vehicle's file says wrongly, during all of the drive
  std::int64_t clock_set_by = 0;  ///< us that all changed stamps are later, as the host's clock was set
  std::vector<std::string>
      drive{};  ///< arguments of `curbstone simulate` for a drive of its own; empty: the common one
};

/// A Change from a function of (double t, Message&) that returns bool, or nothing if every message is sent.
template <class Message, class Function>
[[nodiscard]] Change<Message> change(Function function) {
  return [function](double t, Message& message) mutable {
    if constexpr (std::is_void_v<decltype(function(t, message))>) {
      function(t, message);
      return true;
    } else {
      return function(t, message);
    }
  };
}

}  // namespace curbstone::bench::sensor_faults::catalogue
