#include "common/log/log_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>

namespace curbstone {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kOverlap = 200'000;  // us: MessageOrder's window sorts overlaps up to this
constexpr std::int64_t kGap = 1'000'000;    // us

double to_seconds(std::int64_t us) {
  return static_cast<double>(us) * 1e-6;
}

bool looks_like_a_log(const fs::path& file) {
  if (file.filename().string().find("lcmlog") != std::string::npos) return true;
  char head[4] = {};
  std::ifstream in(file, std::ios::binary);
  return in.read(head, sizeof head) && std::string_view(head, sizeof head) == "\xED\xA1\xDA\x01";
}

}  // namespace

std::vector<std::string> logs_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && looks_like_a_log(entry.path())) names.push_back(entry.path().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

LogFiles::LogFiles(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    if (!fs::is_directory(path)) {
      open(path, true);
      continue;
    }
    const std::vector<std::string> names = logs_in(path);
    if (names.empty()) throw std::runtime_error(fmt::format("{}: there is no LCM log in this folder", path));
    for (const std::string& name : names) open(name, false);
  }
  if (files_.empty()) throw std::runtime_error("there is no message in any of these logs");
  std::stable_sort(files_.begin(), files_.end(), [](const File& a, const File& b) { return a.begin < b.begin; });
  double bytes = 0;
  for (File& file : files_) bytes += file.share = static_cast<double>(fs::file_size(file.name));
  for (File& file : files_) file.share /= bytes;
}

void LogFiles::open(const std::string& name, bool named_by_user) {
  // The process or the power ended before the first message of the file: nothing is lost.
  if (!named_by_user && fs::file_size(name) == 0) {
    notes_.push_back(fmt::format("{} is empty", name));
    return;
  }
  File file{name, std::make_unique<LogReader>(name), {}};
  file.head = file.reader->next();
  if (file.head) {
    file.begin = file.head->log_utime;
    files_.push_back(std::move(file));
  } else {
    notes_.push_back(fmt::format("{} holds no whole message", name));
  }
}

LogFiles::File* LogFiles::earliest() {
  File* earliest = nullptr;
  for (std::size_t i = 0; i < begun_; ++i) {
    if (files_[i].head && (earliest == nullptr || files_[i].head->log_utime < earliest->head->log_utime))
      earliest = &files_[i];
  }
  return earliest;
}

void LogFiles::begin_next() {
  const File* current = earliest();
  const File& next = files_[begun_++];
  if (last_utime_ && next.begin - *last_utime_ > kGap)
    notes_.push_back(fmt::format("gap of {:.1f} s before {}", to_seconds(next.begin - *last_utime_), next.name));
  if (current != nullptr) notes_.push_back(fmt::format("{} overlaps {}", next.name, current->name));
}

std::optional<LogEvent> LogFiles::next() {
  File* file = earliest();
  while (begun_ < files_.size() && (file == nullptr || file->head->log_utime - files_[begun_].begin > kOverlap)) {
    begin_next();
    file = earliest();
  }
  if (file == nullptr) return std::nullopt;
  std::optional<LogEvent> event = std::move(file->head);
  file->head = file->reader->next();
  last_utime_ = event->log_utime;
  return event;
}

std::vector<std::string> LogFiles::names() const {
  std::vector<std::string> names;
  for (const File& file : files_) names.push_back(file.name);
  return names;
}

LogLoss LogFiles::loss() const {
  LogLoss loss;
  for (const File& file : files_) loss += file.reader->loss();
  return loss;
}

std::vector<std::string> LogFiles::notes() const {
  std::vector<std::string> notes = notes_;
  for (const File& file : files_) {
    const std::string loss = to_text(file.reader->loss());
    if (!loss.empty()) notes.push_back(fmt::format("{}: {}", file.name, loss));
  }
  return notes;
}

double LogFiles::progress() const {
  double progress = 0;
  for (const File& file : files_) progress += file.share * file.reader->progress();
  return progress;
}

}  // namespace curbstone
