#include "procman/output/output_keeper.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace curbstone::procman::output {

namespace {

/// File name for an id, whatever characters it has. Two ids never share a name.
std::string file_name(const std::string& id) {
  std::string name;
  for (const char c : id) {
    const bool plain =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("_-.:").find(c) != std::string_view::npos;
    name += plain ? std::string(1, c) : fmt::format("%{:02x}", static_cast<unsigned char>(c));
  }
  return name + ".log";
}

std::string utc(std::int64_t utime) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(static_cast<std::time_t>(utime / 1'000'000)),
                     utime / 1000 % 1000);
}

/// A disk that is full, failing or mounted read-only must not keep the vehicle from driving: that is a fault. Any other
/// error is one of the command line.
bool is_of_the_disk(int error) {
  return error == ENOSPC || error == EDQUOT || error == EROFS || error == EIO;
}

/// Somebody may have deleted an open file, or given its name to another one, as logrotate does.
bool has_its_name(std::FILE* file, const std::string& path) {
  struct stat ours {
  }, there{};
  return fstat(fileno(file), &ours) == 0 && stat(path.c_str(), &there) == 0 && ours.st_ino == there.st_ino &&
         ours.st_dev == there.st_dev;
}

}  // namespace

OutputKeeper::OutputKeeper(std::string folder, KeepLimits limits, std::function<std::int64_t()> clock)
    : folder_(std::move(folder)), limits_(limits), clock_(std::move(clock)) {
  if (folder_.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  const std::string probe = folder_ + "/.curbstone-deputy";
  std::FILE* file = error ? nullptr : std::fopen(probe.c_str(), "we");
  if (file == nullptr) {
    if (is_of_the_disk(error ? error.value() : errno)) return;
    throw std::runtime_error(
        fmt::format("cannot write into the log folder {}: does it exist, and is it ours?", folder_));
  }
  std::fclose(file);
  std::filesystem::remove(probe, error);
}

OutputKeeper::Kept& OutputKeeper::of(const std::string& id) {
  const auto [it, is_new] = kept_.try_emplace(id);
  if (is_new && !folder_.empty()) {
    it->second.path = folder_ + "/" + file_name(id);
    open(it->second);
  }
  return it->second;
}

void OutputKeeper::open(Kept& kept) const {
  std::error_code ignored;  // fopen() reports it
  std::filesystem::create_directories(folder_, ignored);
  kept.file.reset(std::fopen(kept.path.c_str(), "ae"));
  kept.failure = kept.file ? "" : std::strerror(errno);
  std::error_code error;
  const auto size = std::filesystem::file_size(kept.path, error);
  kept.file_size = error ? 0 : static_cast<std::size_t>(size);
}

void OutputKeeper::rotate(Kept& kept) const {
  kept.file.reset();
  std::error_code ignored;
  for (int i = limits_.old_files; i >= 1; --i) {
    const std::string from = i == 1 ? kept.path : fmt::format("{}.{}", kept.path, i - 1);
    std::filesystem::rename(from, fmt::format("{}.{}", kept.path, i), ignored);
  }
  if (limits_.old_files < 1) std::filesystem::remove(kept.path, ignored);
  open(kept);
}

void OutputKeeper::write(Kept& kept, std::string_view text) {
  if (kept.path.empty()) return;
  const std::string line = fmt::format("{} {}", utc(clock_()), text);
  if (kept.file_size + line.size() + 1 > limits_.file_bytes && kept.file_size > 0) rotate(kept);
  if (!kept.file || !has_its_name(kept.file.get(), kept.path)) open(kept);
  const bool written = kept.file && std::fwrite(line.data(), 1, line.size(), kept.file.get()) == line.size() &&
                       std::fputc('\n', kept.file.get()) != EOF && std::fflush(kept.file.get()) == 0;
  if (kept.file) kept.failure = written ? "" : std::strerror(errno);
  if (written) {
    kept.file_size += line.size() + 1;
  } else {
    ++write_failures_;
    if (kept.file) std::clearerr(kept.file.get());
  }
}

std::optional<std::string> OutputKeeper::fault() const {
  for (const auto& [id, kept] : kept_) {
    if (kept.failure.empty()) continue;
    return fmt::format("{}: {}: what the command prints is kept in memory only", kept.path, kept.failure);
  }
  return std::nullopt;
}

void OutputKeeper::note(const std::string& id, std::string_view line) {
  write(of(id), line);
}

const std::deque<std::string>& OutputKeeper::last_lines(const std::string& id) {
  return of(id).lines;
}

std::vector<std::string> OutputKeeper::last_lines(const std::string& id, std::size_t most) {
  const std::deque<std::string>& lines = last_lines(id);
  return {lines.end() - static_cast<std::ptrdiff_t>(std::min(lines.size(), most)), lines.end()};
}

}  // namespace curbstone::procman::output
