#include "tools/play/play.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <set>
#include <stdexcept>

#include "common/bus/lcm_bus.hpp"
#include "common/config/command_line.hpp"
#include "common/shell/event_loop.hpp"
#include "common/time/clock.hpp"
#include "tools/log_tool/channel_pattern.hpp"
#include "tools/log_tool/log_time.hpp"
#include "tools/output/progress_bar.hpp"
#include "tools/play/keyboard.hpp"
#include "tools/play/keys.hpp"
#include "tools/play/player.hpp"

namespace curbstone::play {

namespace {

constexpr const char* kSensors = "LIDAR_POINTS|LIDAR_RAW|IMU|WHEELS";
constexpr std::int64_t kListen = 1'500'000;  // us; all drivers publish more often

struct PlayOptions {
  std::vector<std::string> logs;
  std::string channels = kSensors;
  std::string from;
  std::string url;
  double speed = 1;
};

/// The channels to be played that already have a publisher.
std::set<std::string> spoken_on(LcmBus& bus, const Player::Wanted& wanted) {
  std::set<std::string> channels;
  bool listening = true;
  bus.tap(
      [&](const std::string& channel, const void*, int, std::int64_t) {
        if (listening && wanted(channel)) channels.insert(channel);
      },
      {});
  const std::int64_t end = steady_clock() + kListen;
  while (steady_clock() < end && channels.empty()) bus.handle(std::chrono::milliseconds(50));
  listening = false;
  return channels;
}

void refuse_a_bus_in_use(const std::string& url, const Player::Wanted& wanted) {
  LcmBus bus(url);  // listens only, and is closed before anything is published
  const std::set<std::string> channels = spoken_on(bus, wanted);
  if (!channels.empty())
    throw std::runtime_error(
        fmt::format("somebody speaks on {} of {} already: stop the drivers, or play on another bus "
                    "(--lcm-url), to which you start the services too",
                    fmt::join(channels, ", "), bus.url()));
}

void play(Player& player, EventLoop& loop) {
  Keyboard keyboard;
  output::ProgressBar bar("play");
  if (keyboard.is_there()) {
    fmt::print(stderr, "space: pause; .: step; arrows: 10 s on or back; + -: speed; q: end\n");
    loop.watch(Keyboard::fd(), [&] {
      const std::string keys = keyboard.pressed();
      if (keys.empty()) loop.unwatch(Keyboard::fd());  // the terminal was closed
      if (!apply_keys(keys, player)) loop.stop();
    });
  }
  loop.every(std::chrono::milliseconds(2), [&] {
    player.advance(steady_clock());
    bar.show(player.progress(), fmt::format("{:.1f} s  {}x{}", static_cast<double>(player.position()) * 1e-6,
                                            player.speed(), player.paused() ? "  paused" : ""));
    if (player.at_end()) loop.stop();
  });
  loop.run();
}

}  // namespace

int run_play(int argc, char** argv) {
  PlayOptions options;
  CommandLine line(
      "Says what the drivers said in a log on the bus, with the times of the log. On a terminal: space pauses, '.' "
      "steps, the arrows go 10 s on or back, + and - change the speed, q ends",
      "curbstone play");
  line.option("log", options.logs, "LCM logs, or the folder of a session").required();
  line.option("--channels", options.channels, "Regular expression that fits the whole name; '.*': all").shows_default();
  line.option("--from", options.from, "Where to begin: seconds from the beginning, or UTC (2026-11-23T20:52:00Z)");
  line.option("--speed", options.speed, "Times the pace of the drive").within(0.01, 100.0).shows_default();
  line.option("--lcm-url", options.url, "Bus; default $LCM_DEFAULT_URL, else " + std::string(LcmBus::kDefaultUrl));
  if (const auto status = line.read(argc, argv)) return *status;
  const log_tool::ChannelPattern pattern(options.channels);
  const auto wanted = [&](const std::string& channel) { return pattern.fits(channel); };
  EventLoop loop;  // before the threads of a bus, so that Ctrl-C ends the loop and the terminal is restored
  refuse_a_bus_in_use(options.url, wanted);
  LcmBus bus(options.url);
  Player player(options.logs, bus, wanted);
  player.set_speed(options.speed);
  if (!options.from.empty())
    player.seek(log_tool::LogTime(options.from, "--from").in_log(player.begin()) - player.begin());
  play(player, loop);
  for (const std::string& note : player.files().notes()) fmt::print(stderr, "curbstone play: {}\n", note);
  fmt::print("{} messages\n", player.published());
  if (player.published() == 0) throw std::runtime_error("nothing was played: 'curbstone log info' lists the channels");
  return player.files().loss().damaged() ? 1 : 0;
}

}  // namespace curbstone::play
