#include "tools/bench/latency/drive_parts.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <ctime>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

namespace curbstone::bench::latency {

namespace {

double cpu_seconds_of_process() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}

double resident_megabytes() {
  std::ifstream statm("/proc/self/statm");
  double size = 0;
  double resident = 0;  // pages
  statm >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
}

}  // namespace

DriveParts::DriveParts(TimedVehicle& vehicle, double seconds)
    : vehicle_(vehicle), length_(std::llround(seconds * 1e6)), all_cpu_before_(cpu_seconds_of_process()) {}

void DriveParts::on_message(const TimedMessage& message) {
  ages_.on_message(message);
  if (message.channel == "MAP_POSE") {
    map_pose_t m;
    if (!message.decode(m)) return;
    const std::vector<double> place(m.map_base_position, m.map_base_position + 2);
    if (!last_place_.empty()) driven_ += std::hypot(place[0] - last_place_[0], place[1] - last_place_[1]);
    last_place_ = place;
  } else if (message.channel == "SEMANTIC_TILE") {
    semantic_tile_t m;
    if (message.decode(m)) tiles_.insert({m.tile_x, m.tile_y});
  }
}

std::optional<DrivePart> DriveParts::reach(std::int64_t utime) {
  if (begin_ == 0) begin_ = part_begin_ = utime;
  if (utime - part_begin_ < length_) return std::nullopt;
  return end_part(utime);
}

DrivePart DriveParts::end_part(std::int64_t utime) {
  const double seconds = static_cast<double>(utime - part_begin_) * 1e-6;
  DrivePart part;
  part.end = static_cast<double>(utime - begin_) * 1e-6;
  part.driven = driven_;
  part.tiles = tiles_.size();
  const double all_cpu = cpu_seconds_of_process();
  part.other_cores = (all_cpu - all_cpu_before_) / seconds;
  all_cpu_before_ = all_cpu;
  for (const auto& [name, process] : vehicle_.processes()) {
    std::int64_t& before = cpu_before_[name];
    part.cores[name] = static_cast<double>(process->cpu_us() - before) * 1e-6 / seconds;
    before = process->cpu_us();
    part.other_cores -= part.cores[name];
    part.longest_ms[name] = static_cast<double>(process->take_longest_us()) * 1e-3;
  }
  part.age = ages_.news();
  ages_ = ages_.next_part();
  part.memory_mb = resident_megabytes();
  part_begin_ = utime;
  return part;
}

std::string parts_heading(const DrivePart& first) {
  std::string text = fmt::format("{:>6} {:>7} {:>7}", "s", "m", "tiles");
  for (const auto& [name, cores] : first.cores) text += fmt::format(" {:>22}", name);
  text += fmt::format(" {:>6} {:>16} {:>6}\n{:>22}", "other", "points to tile", "memory", "");
  for (std::size_t i = 0; i < first.cores.size(); ++i) text += fmt::format(" {:>22}", "cores, longest ms");
  return text + fmt::format(" {:>6} {:>16} {:>6}\n", "cores", "p95, max ms", "MB");
}

std::string part_line(const DrivePart& part) {
  std::string text = fmt::format("{:>6.0f} {:>7.0f} {:>7}", part.end, part.driven, part.tiles);
  for (const auto& [name, cores] : part.cores)
    text += fmt::format(" {:>13.3f} {:>8.1f}", cores, part.longest_ms.at(name));
  return text + fmt::format(" {:>6.3f} {:>8.0f} {:>7.0f} {:>6.0f}\n", part.other_cores, part.age.p95, part.age.max,
                            part.memory_mb);
}

nlohmann::json to_json(const DrivePart& part) {
  return {{"s", part.end},
          {"m", part.driven},
          {"tiles", part.tiles},
          {"cores", part.cores},
          {"longest_ms", part.longest_ms},
          {"other_cores", part.other_cores},
          {"age_p95_ms", part.age.p95},
          {"age_max_ms", part.age.max},
          {"memory_mb", part.memory_mb}};
}

}  // namespace curbstone::bench::latency
