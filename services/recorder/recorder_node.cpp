#include "services/recorder/recorder_node.hpp"

#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/time/has_passed.hpp"

namespace curbstone::recorder {
namespace {

constexpr std::int64_t kPeriod = 1'000'000;       // us
constexpr std::int64_t kDeletedFor = 60'000'000;  // us for which a deleted file is reported

/// A disk that is full, failing or mounted read-only may be mended while the vehicle drives.
bool may_be_mended(const std::error_code& error) {
  return error == std::errc::no_space_on_device || error == std::errc::read_only_file_system ||
         error == std::errc::io_error;
}

}  // namespace

RecorderNode::RecorderNode(const RecorderConfig& config, Tappable& bus, std::int64_t now)
    : config_(config), space_(config.folder, static_cast<std::int64_t>(config.keep_free * 1e9)) {
  try {
    if (has_room()) begin(now);
  } catch (const std::system_error& error) {
    if (!may_be_mended(error.code())) throw;
    stop(error.what());
  }
  const auto write_any = [this](const std::string& channel, const void* data, int size, std::int64_t utime) {
    write(channel, data, size, utime);
  };
  bus.tap(write_any, {.capacity = config.queue}, config.skip);
}

void RecorderNode::begin(std::int64_t now) {
  if (config_.file.empty() && !session_) {
    session_.emplace(config_.folder, now);
    if (last_ != 0) session_->write_config(configs_.yaml());  // heard while there was no disk
  }
  const auto next_name = [this] { return session_ ? session_->next_log() : unused_name(config_.file); };
  const auto head = [this](LogWriter& log, std::int64_t utime) { configs_.write(log, utime); };
  recording_.emplace(next_name, std::int64_t{config_.split_mb} * 1'000'000, head);
}

bool RecorderNode::has_room() {
  if (!config_.file.empty()) return true;
  std::error_code ignored;
  if (!session_) std::filesystem::create_directories(config_.folder, ignored);  // its disk is that of the space
  const std::int64_t deleted = space_.deleted();
  const bool room = space_.make_room(session_ ? session_->path() : std::filesystem::path());
  if (space_.deleted() > deleted) report_.counters.add("deleted.sessions", space_.deleted() - deleted);
  if (!room) stop(space_.why_refused());
  return room;
}

void RecorderNode::write(const std::string& channel, const void* data, int size, std::int64_t utime) {
  const bool is_new = channel == "CONFIG" && configs_.take(data, size);
  if (is_new && session_) session_->write_config(configs_.yaml());
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
  if (!has_passed(kPeriod, last_, now)) return;
  last_ = now;
  if (recording_) {
    flush();
    (void)has_room();
    return;
  }
  if (!has_room()) return;
  try {
    begin(now);
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
    if (deleted_ != 0 && last_ - deleted_ < kDeletedFor) report_.faults.push_back(why_deleted_);
  } catch (const FileDeleted& error) {
    deleted_ = last_;
    why_deleted_ = error.what();
    report_.counters.add("lost.deleted", recording_->num_records() - waiting_);
    stop(error.what());
  } catch (const std::runtime_error& error) {
    stop(error.what());
  }
}

void RecorderNode::stop(const std::string& why) {
  recording_.reset();
  report_.counters.add("lost.unwritten", std::exchange(waiting_, 0));
  report_.faults = {why};
}

NodeReport RecorderNode::report() const {
  return report_;
}

}  // namespace curbstone::recorder
