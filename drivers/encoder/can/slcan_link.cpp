#include "drivers/encoder/can/slcan_link.hpp"

#include <utility>

#include "common/time/clock.hpp"

namespace curbstone::encoder::can {

SlcanLink::SlcanLink(const serial::SerialSettings& serial, int bitrate)
    : channel_(bitrate, {[this](auto bytes) { serial_.send(bytes); },
                         [this](std::int64_t utime, const CanFrame& frame) { handlers_.on_frame(utime, frame); },
                         [this](std::int64_t now) { handlers_.on_link(now, link::LinkState::kUp, ""); },
                         [this](std::int64_t now, const char* cause) { handlers_.on_refused(now, cause); }}),
      serial_(serial) {}

void SlcanLink::attach(EventLoop& loop, Handlers handlers) {
  handlers_ = std::move(handlers);
  handlers_.on_link(wall_clock(), link::LinkState::kDown, "the SLCAN adapter's channel is being opened");
  serial_.attach(loop, {[this](auto utime, auto bytes) { channel_.on_bytes(utime, bytes); },
                        [this](std::int64_t now, link::LinkState state, const std::string& why) {
                          port_up_ = state == link::LinkState::kUp;
                          if (port_up_) {
                            channel_.start(now);
                          } else {
                            handlers_.on_link(now, link::LinkState::kDown, why);
                          }
                        }});
  loop.every(std::chrono::milliseconds(20), [this] {
    if (port_up_) channel_.tick(wall_clock());
  });
}

void SlcanLink::report(NodeReport& report) const {
  report.counters.add(channel_.counters());
  serial_.report(report);
  if (!port_up_) return;
  for (std::string& fault : channel_.faults()) report.faults.push_back(std::move(fault));
}

}  // namespace curbstone::encoder::can
