#include "drivers/imu/witmotion/wit_configurator.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace curbstone::imu::witmotion {

namespace {

constexpr std::int64_t kPause = 100'000;  // us between commands: at 9600 baud the device processes them slowly

struct Rate {
  int hz;
  std::uint8_t code;
};
constexpr std::array<Rate, 7> kRates = {{{1, 3}, {2, 4}, {5, 5}, {10, 6}, {20, 7}, {50, 8}, {100, 9}}};
constexpr Rate kMaxRate = {200, 0xB};

/// The fastest rate that is not above `hz`.
Rate rate_for(int hz) {
  if (hz >= kMaxRate.hz) return kMaxRate;
  Rate best = kRates[0];
  for (const Rate& rate : kRates) best = rate.hz <= hz ? rate : best;
  return best;
}

}  // namespace

WitConfigurator::WitConfigurator(const Settings& settings, Send send) : settings_(settings), send_(std::move(send)) {
  const Rate rate = rate_for(settings.rate);
  rate_ = rate.hz;
  const std::uint8_t frames = 0b111;  // time, acceleration, rate of turn
  const std::uint8_t more = settings.orientation ? 0b10 : 0;
  commands_ = {{0xFF, 0xAA, 0x69, 0x88, 0xB5},  // unlock
               {0xFF, 0xAA, 0x02, frames, more},
               {0xFF, 0xAA, 0x03, rate.code, 0x00}};
  next_ = commands_.size();
  if (settings.enabled && rate.hz != settings.rate) {
    fault_ = fmt::format("the IMU has no {} Hz: it is set to {} Hz", settings.rate, rate.hz);
  }
}

void WitConfigurator::start(std::int64_t now) {
  started_ = true;
  silence_.heard();
  if (!settings_.enabled) return;
  next_ = 0;
  sent_ = now - kPause;
}

void WitConfigurator::tick(std::int64_t now) {
  silence_.tick(now);
  if (!started_) start(now);
  if (!settings_.enabled) return;
  if (next_ < commands_.size()) {
    if (now - sent_ < kPause && now >= sent_) return;
    send_(commands_[next_++]);
    counters_.add("device.commands");
    sent_ = now;
    silence_.heard();
  } else if (silence_.silent() > settings_.patience) {
    counters_.add("device.reconfigured");
    start(now);
  }
}

}  // namespace curbstone::imu::witmotion
