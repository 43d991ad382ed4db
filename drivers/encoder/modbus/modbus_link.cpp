#include "drivers/encoder/modbus/modbus_link.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/bus/levels.hpp"
#include "common/time/clock.hpp"

namespace curbstone::encoder::modbus {

namespace {

constexpr std::int64_t kFirstRetry = 100'000;  // us
constexpr std::int64_t kLastRetry = 1'000'000;
constexpr std::int64_t kGap = 2'000;  // us between two requests: 3.5 characters, at least 1.75 ms
constexpr std::array<int, 5> kBauds = {9600, 19200, 38400, 57600, 115200};  // supported by the drive and libmodbus

/// Throws for settings that libmodbus would only reject when it opens the port, or never.
void check(const ModbusSettings& settings) {
  in_addr address{};
  if (settings.tcp && inet_pton(AF_INET, settings.host.c_str(), &address) != 1)
    throw std::invalid_argument(fmt::format("encoder.modbus.host: '{}' is no IPv4 address", settings.host));
  if (!settings.tcp && std::ranges::find(kBauds, settings.baud) == kBauds.end())
    throw std::invalid_argument(
        fmt::format("encoder.baud: {}: for Modbus use {}", settings.baud, fmt::join(kBauds, ", ")));
}

}  // namespace

ModbusLink::ModbusLink(const ModbusSettings& settings, double rate)
    : settings_(settings),
      period_(static_cast<std::int64_t>(1e6 / rate)),
      client_(settings),
      poll_([this](const Block& block, std::span<std::uint16_t> registers) { return client_.read(block, registers); },
            [this] {
              if (!settings_.tcp) std::this_thread::sleep_for(std::chrono::microseconds(kGap));
            }) {
  check(settings);
  event_fd_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (event_fd_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

ModbusLink::~ModbusLink() {
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
  }
  close(event_fd_);
}

void ModbusLink::attach(EventLoop& loop, Handlers handlers) {
  handlers_ = std::move(handlers);
  handlers_.on_link(link::LinkState::kDown, fmt::format("Modbus {} is being opened", client_.name()));
  loop.watch(event_fd_, [this] { on_readable(); });
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void ModbusLink::run(const std::stop_token& stop) {
  std::int64_t pause = kFirstRetry;
  while (!stop.stop_requested()) {
    if (!open(stop)) return;
    bool has_read = false;
    std::int64_t due = steady_clock();
    while (!stop.stop_requested() && !poll_.must_reopen()) {
      poll_.tick(steady_clock());
      poll_.poll([&](const Reading& reading) {
        has_read = true;
        post({reading, link::LinkState::kUp, {}});
      });
      share_report();
      due = std::max(due + period_, steady_clock() + kGap);  // after a delay no burst of polls
      if (!sleep_until(due, stop)) break;
    }
    client_.close();
    if (stop.stop_requested()) return;
    if (has_read || !poll_.is_gone() || !settings_.tcp) {
      pause = kFirstRetry;
      post({{}, link::LinkState::kDown, fmt::format("Modbus {}: lost; opening it anew", client_.name())});
      continue;
    }
    post({{},
          link::LinkState::kDown,
          fmt::format("Modbus {}: closed by the other end before it gave positions: has another program its "
                      "only connection, or does it close each after one reply?",
                      client_.name())});
    if (!sleep_until(steady_clock() + pause, stop)) return;
    pause = std::min(2 * pause, kLastRetry);
  }
}

/// Retries until it is open; false if the thread is to end.
bool ModbusLink::open(const std::stop_token& stop) {
  for (std::int64_t wait = kFirstRetry; !stop.stop_requested(); wait = std::min(2 * wait, kLastRetry)) {
    const std::string why = client_.open();
    if (why.empty()) {
      ++openings_;
      poll_.restart();
      post({{}, link::LinkState::kUp, {}});
      return true;
    }
    post({{}, link::LinkState::kDown, why});
    poll_.tick(steady_clock());
    share_report();
    if (!sleep_until(steady_clock() + wait, stop)) return false;
  }
  return false;
}

/// False if the thread is to end.
bool ModbusLink::sleep_until(std::int64_t time, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  const auto span = std::chrono::microseconds(std::max<std::int64_t>(time - steady_clock(), 0));
  wake_.wait_for(lock, stop, span, [] { return false; });
  return !stop.stop_requested();
}

void ModbusLink::post(Event event) {
  {
    const std::lock_guard lock(mutex_);
    if (queue_.size() == kMaxQueue) {
      queue_.pop_front();
      ++dropped_;
    }
    queue_.push_back(std::move(event));
  }
  const std::uint64_t one = 1;
  (void)!write(event_fd_, &one, sizeof one);
}

void ModbusLink::share_report() {
  const std::lock_guard lock(mutex_);
  counters_ = poll_.counters();
  counters_.set("modbus.openings", openings_);
  if (!settings_.tcp && openings_ > 0)
    set_level(counters_, "serial.low_latency", client_.low_latency().granted ? 1 : 0);
  if (const auto timer = client_.low_latency().timer_ms) set_level(counters_, "serial.latency_timer_ms", *timer);
  fault_ = poll_.fault();
  share_fault_ = poll_.share().fault();
}

void ModbusLink::on_readable() {
  std::uint64_t count = 0;
  (void)!read(event_fd_, &count, sizeof count);
  std::deque<Event> events;
  {
    const std::lock_guard lock(mutex_);
    events.swap(queue_);
  }
  for (const Event& event : events) {
    if (event.reading) {
      handlers_.on_reading(*event.reading);
    } else {
      handlers_.on_link(event.link, event.why);
    }
  }
}

void ModbusLink::report(NodeReport& report) const {
  const std::lock_guard lock(mutex_);
  report.counters.add(counters_);
  if (dropped_ > 0) report.counters.add("dropped.queue", dropped_);
  if (!fault_.empty()) report.faults.push_back(fault_);
  if (share_fault_) report.faults.push_back(*share_fault_);
}

}  // namespace curbstone::encoder::modbus
