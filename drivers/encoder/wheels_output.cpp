#include "drivers/encoder/wheels_output.hpp"

#include <utility>

#include "common/bus/levels.hpp"
#include "common/bus/sequence_number.hpp"

namespace curbstone::encoder {

namespace {
constexpr std::int64_t kSetBack = 100'000;  // us: after a smaller step samples wait for the host's clock
}

wheels_t WheelsOutput::message(const WheelCounter::Sample& sample, std::int64_t utime) {
  wheels_t message{};
  message.utime = utime;
  for (std::size_t i = 0; i < 2; ++i) {
    message.counts[i] = sample.counts[i];
    message.angle[i] = sample.angle[i];
    message.speed[i] = sample.speed[i];
  }
  return message;
}

void WheelsOutput::publish(wheels_t& message, std::int64_t now) {
  if (message.utime <= last_utime_) {
    counters_.add("dropped.not_newer");
    return;
  }
  last_utime_ = message.utime;
  message.sequence = std::exchange(sequence_, next_sequence_number(sequence_));
  bus_.publish("WHEELS", message);
  counters_.add("samples");
  latency_.add(static_cast<double>(now - message.utime) * 1e-6);
  arrival_.add(message.utime, now);
}

void WheelsOutput::restart(std::int64_t utime) {
  if (utime >= last_utime_ - kSetBack) return;
  counters_.add("clock_jumps");
  last_utime_ = 0;
}

void WheelsOutput::report(NodeReport& report) const {
  report.counters.add(counters_);
  report.latency_p50 = latency_.percentile(0.5);
  report.latency_p99 = latency_.percentile(0.99);
  if (const auto difference = arrival_.difference()) set_level(report.counters, "clock.difference_us", *difference);
  if (auto fault = arrival_.fault()) report.faults.push_back(std::move(*fault));
}

}  // namespace curbstone::encoder
