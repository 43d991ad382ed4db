#include "tools/bench/sensor_faults/catalogue/faulty_messages.hpp"

#include <stdexcept>
#include <utility>

#include "common/bus/decode.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

namespace {

template <class Message>
bool apply_to(const Change<Message>& change, double t, LogEvent& event) {
  if (!change) return true;
  Message message;
  if (!decode(event.bytes.data(), static_cast<int>(event.bytes.size()), message))
    throw std::runtime_error("the log has a message on " + event.channel + " that is none");
  if (!change(t, message)) return false;
  event.bytes.resize(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(event.bytes.data(), 0, static_cast<int>(event.bytes.size()));
  return true;
}

template <class Message>
std::optional<LogEvent> second_of(const Change<Message>& change, double t, const LogEvent& event) {
  LogEvent other = event;
  return change && apply_to(change, t, other) ? std::optional(std::move(other)) : std::nullopt;
}

}  // namespace

bool FaultyMessages::apply(double t, LogEvent& event) {
  if (t < from_) return true;
  if (event.channel == "LIDAR_POINTS") return apply_to(changes_.lidar, t, event);
  if (event.channel == "IMU") return apply_to(changes_.imu, t, event);
  if (event.channel == "WHEELS") return apply_to(changes_.wheels, t, event);
  return true;
}

std::optional<LogEvent> FaultyMessages::second(double t, const LogEvent& event) {
  if (t < from_) return std::nullopt;
  if (event.channel == "LIDAR_POINTS") return second_of(changes_.second_lidar, t, event);
  if (event.channel == "IMU") return second_of(changes_.second_imu, t, event);
  if (event.channel == "WHEELS") return second_of(changes_.second_wheels, t, event);
  return std::nullopt;
}

}  // namespace curbstone::bench::sensor_faults::catalogue
