#include "tools/bench/viewer/viewer_cpu.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/local_bus.hpp"
#include "tools/bench/programs/background_program.hpp"
#include "tools/bench/viewer/reading_client.hpp"
#include "tools/command/program_beside.hpp"
#include "tools/output/ordered_log.hpp"
#include "tools/output/watched_log.hpp"
#include "tools/replay/vehicle.hpp"

namespace curbstone::bench::viewer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::int64_t kVehicleTick = 20'000;  // us
constexpr double kStart = 20;                  // s for the viewer to start
constexpr std::array<std::string_view, 7> kHeard = {"SEMANTIC_TILE", "TILE_INDEX",     "MAP_POSE",    "CURBS",
                                                    "MARKINGS",      "MAP_TRAJECTORY", "LIDAR_POINTS"};

/// A message as it was encoded; stands for its type at publish().
struct Encoded {
  std::int64_t at = 0;  // us since the drive's begin
  std::string channel;
  std::vector<std::uint8_t> bytes;

  [[nodiscard]] int getEncodedSize() const { return static_cast<int>(bytes.size()); }
  int encode(void* to, int offset, int most) const {
    if (most < getEncodedSize()) return -1;
    std::memcpy(static_cast<std::uint8_t*>(to) + offset, bytes.data(), bytes.size());
    return getEncodedSize();
  }
};

/// What the viewer hears in the first `seconds` of the drive.
std::vector<Encoded> map_drive(const std::string& log, double seconds) {
  output::WatchedLog reader(log, "bench viewer");
  LocalBus bus;
  std::vector<Encoded> sent;
  std::int64_t first = 0, now = 0;
  bus.tap([&](const std::string& channel, const void* data, int size, std::int64_t) {
    if (std::find(kHeard.begin(), kHeard.end(), channel) == kHeard.end()) return;
    const auto* begin = static_cast<const std::uint8_t*>(data);
    sent.push_back({now - first, channel, {begin, begin + size}});
  });
  replay::ReplayOptions options;
  options.assignments = {"mapper.folder=", "semantic_map.map="};  // writes nothing to the disk
  options.tick_period = kVehicleTick;
  replay::ReplayVehicle vehicle(options, bus);
  while (const auto event = reader.next()) {
    if (!output::is_of_a_driver(event->channel)) continue;
    if (first == 0) first = now = event->log_utime;
    if (static_cast<double>(event->log_utime - first) * 1e-6 > seconds) break;
    if (event->log_utime - now >= kVehicleTick) {
      now = event->log_utime;
      vehicle.advance(now);
      bus.dispatch();
    }
    bus.inject(event->channel, event->bytes.data(), static_cast<int>(event->bytes.size()));
    bus.dispatch();
  }
  if (sent.empty()) throw std::runtime_error(log + ": holds no LIDAR_POINTS, IMU or WHEELS");
  return sent;
}

/// s that the process has used the processor, in and out of the kernel.
double cpu_of(pid_t process) {
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  std::string text;
  std::getline(file, text);
  std::istringstream words(text.substr(std::min(text.size(), text.rfind(')') + 1)));  // behind the name
  std::string skipped;
  for (int i = 0; i < 11; ++i) words >> skipped;  // up to field 13
  long user = 0, system = 0;
  if (!(words >> user >> system)) throw std::runtime_error("bench viewer: curbstone-viewer has ended");
  return static_cast<double>(user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

std::uint16_t port_of(programs::BackgroundProgram& viewer) {
  constexpr std::string_view kBefore = "viewer: http://127.0.0.1:";
  for (const auto begin = Clock::now(); Clock::now() - begin < std::chrono::duration<double>(kStart);) {
    const std::string output = viewer.output();
    const std::size_t at = output.find(kBefore);
    if (at != std::string::npos && output.find('/', at + kBefore.size()) != std::string::npos)
      return static_cast<std::uint16_t>(std::stoi(output.substr(at + kBefore.size())));
    if (!viewer.running()) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  throw std::runtime_error("bench viewer: curbstone-viewer does not start: " + viewer.output());
}

struct Run {
  double cores = 0;
  double frames_per_s = 0;
  double mb_per_s = 0;
};

Run play(const std::vector<Encoded>& drive, int pages) {
  const std::string folder = std::filesystem::temp_directory_path() / fmt::format("curbstone-viewer-cpu-{}", getpid());
  const std::string url = fmt::format("udpm://239.255.76.67:{}?ttl=0", 20'000 + getpid() % 20'000);
  programs::BackgroundProgram viewer(
      fmt::format("'{}/curbstone-viewer' --lcm-url '{}' --set port=0", command::own_folder().string(), url),
      folder + ".out");
  const std::uint16_t port = port_of(viewer);
  std::filesystem::remove(folder + ".out");
  LcmBus bus(url);
  std::vector<std::unique_ptr<ReadingClient>> clients;
  for (int i = 0; i < pages; ++i) clients.push_back(std::make_unique<ReadingClient>(port));
  const auto read = [&] {
    for (const auto& client : clients) client->read();
  };
  const double before = cpu_of(viewer.pid());
  const auto begin = Clock::now();
  for (const Encoded& message : drive) {
    while (Clock::now() - begin < std::chrono::microseconds(message.at)) {
      read();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    bus.publish(message.channel, message);
  }
  read();
  const double took = std::chrono::duration<double>(Clock::now() - begin).count();
  Run run{.cores = (cpu_of(viewer.pid()) - before) / took};
  if (pages > 0) {
    run.frames_per_s = static_cast<double>(clients.front()->frames()) / took;
    run.mb_per_s = static_cast<double>(clients.front()->bytes()) * 1e-6 / took;
  }
  viewer.send_signal(SIGTERM);
  viewer.wait(5);
  return run;
}

}  // namespace

ViewerCpu measure_cpu(const std::string& log, double seconds) {
  const std::vector<Encoded> drive = map_drive(log, seconds);
  const Run alone = play(drive, 0), with_two = play(drive, 2);
  return {.seconds = static_cast<double>(drive.back().at) * 1e-6,
          .without_page = alone.cores,
          .with_two_pages = with_two.cores,
          .frames_per_s = with_two.frames_per_s,
          .mb_per_s = with_two.mb_per_s};
}

}  // namespace curbstone::bench::viewer
