#include "services/recorder/recorder_node.hpp"

#include <stdexcept>
#include <utility>

namespace curbstone::recorder {
namespace {

constexpr std::int64_t kPeriod = 1'000'000;  // us

}  // namespace

RecorderNode::RecorderNode(const RecorderConfig& config, Tappable& bus) : config_(config) {
  begin();
  const auto write_any = [this](const std::string& channel, const void* data, int size, std::int64_t utime) {
    write(channel, data, size, utime);
  };
  bus.tap(write_any, {.capacity = config.queue}, config.skip);
}

void RecorderNode::begin() {
  recording_.emplace(config_.file, std::int64_t{config_.split_mb} * 1'000'000);
}

void RecorderNode::write(const std::string& channel, const void* data, int size, std::int64_t utime) {
  if (!recording_) {
    report_.counters.add("lost.unwritten");
    return;
  }
  try {
    recording_->write(channel, data, size, utime);
    ++waiting_;
  } catch (const std::runtime_error& error) {
    ++waiting_;
    stop(error.what());
  }
}

void RecorderNode::tick(std::int64_t now) {
  if (now - last_ < kPeriod) return;
  last_ = now;
  if (recording_) {
    flush();
    return;
  }
  try {
    begin();
  } catch (const std::runtime_error& error) {
    stop(error.what());
  }
}

void RecorderNode::finish() {
  if (recording_) flush();
}

void RecorderNode::flush() {
  try {
    recording_->flush();
    report_.counters.add("messages", std::exchange(waiting_, 0));
    report_.faults.clear();
  } catch (const std::runtime_error& error) {
    stop(error.what());
  }
}

void RecorderNode::stop(const char* why) {
  recording_.reset();
  report_.counters.add("lost.unwritten", std::exchange(waiting_, 0));
  report_.faults = {why};
}

NodeReport RecorderNode::report() const {
  return report_;
}

}  // namespace curbstone::recorder
