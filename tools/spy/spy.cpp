#include "tools/spy/spy.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <string>

#include "common/bus/lcm_bus.hpp"
#include "common/config/command_line.hpp"
#include "common/shell/event_loop.hpp"
#include "common/terminal/screen.hpp"
#include "common/time/clock.hpp"
#include "tools/output/new_file.hpp"
#include "tools/spy/trace/chain_trace.hpp"
#include "tools/spy/trace/trace_json.hpp"
#include "tools/spy/view.hpp"

namespace curbstone::spy {

namespace {

struct SpyOptions {
  std::string channel;
  std::string url;
  std::string trace;
  double seconds = 2.0;
  bool once = false;
  bool json = false;
};

std::vector<std::string> picture(const board::BusBoard& board, const TextStyle& style) {
  const std::int64_t now = wall_clock();
  return board.followed().empty() ? board_lines(board, now, style) : message_lines(board, now, style);
}

void listen(LcmBus& bus, double seconds) {
  const std::int64_t end = steady_clock() + static_cast<std::int64_t>(seconds * 1e6);
  for (std::int64_t left; (left = end - steady_clock()) > 0;) bus.handle(std::chrono::milliseconds(left / 1000 + 1));
}

/// Returns the exit status.
int show_once(LcmBus& bus, const board::BusBoard& board, const SpyOptions& options) {
  listen(bus, options.seconds);
  if (options.json)
    fmt::print("{}\n", board_json(board, wall_clock()));
  else
    Screen(STDOUT_FILENO).show(picture(board, Screen(STDOUT_FILENO).style()));
  const bool heard = options.channel.empty() ? !board.channels().empty() : board.channels().contains(options.channel);
  return heard ? 0 : 1;
}

/// Returns the exit status.
int write_trace(const SpyOptions& options) {
  output::NewFile file(options.trace, true);
  LcmBus bus(options.url);
  trace::ChainTrace chain;
  bus.tap([&](const std::string& channel, const void* data, int size,
              std::int64_t utime) { chain.on_message(channel, data, static_cast<std::size_t>(size), utime); },
          {20'000}, "");
  listen(bus, options.seconds);
  std::ofstream out(file.part());
  out << trace::trace_json(chain);
  if (!out.flush()) throw std::runtime_error(options.trace + ": cannot be written");
  out.close();
  file.commit();
  fmt::print("{}: {} spans of {} channels in {:.1f} s; https://ui.perfetto.dev opens it\n", options.trace,
             chain.spans(), chain.channels().size(), options.seconds);
  return chain.spans() > 0 ? 0 : 1;
}

void show_live(LcmBus& bus, const board::BusBoard& board, EventLoop& loop) {
  const Screen screen(STDOUT_FILENO);
  loop.watch(bus.fd(), [&] { bus.handle(std::chrono::milliseconds(0)); });
  loop.every(std::chrono::milliseconds(1000), [&] {
    std::vector<std::string> lines = picture(board, screen.style());
    if (!screen.is_terminal()) lines.emplace_back();
    if (!screen.show(lines)) loop.stop();
  });
  loop.run();
  if (screen.is_terminal()) fmt::print("\n");
}

}  // namespace

int run_spy(int argc, char** argv) {
  SpyOptions options;
  CommandLine line(
      "Who sends what on the bus, how fast, what is lost, and how the services are. With a channel: its messages, "
      "field by field.",
      "curbstone spy");
  line.argument("channel", options.channel, "Show its last message; default: the whole bus");
  line.option("--lcm-url", options.url, "Bus; default $LCM_DEFAULT_URL, else loopback");
  line.flag("--once", options.once, "Listen for --seconds, print once, and end; exit status 1: nothing came");
  line.option("--trace", options.trace,
              "Listen for --seconds, and write where the time goes from packets to tiles: Chrome trace JSON, for "
              "Perfetto; exit status 1: nothing came");
  line.option("--seconds", options.seconds, "How long, with --once and --trace").within(0.1, 3600.0).shows_default();
  line.flag("--json", options.json, "For programs, with --once");
  if (const auto status = line.read(argc, argv)) return *status;
  if (options.json && !options.once) return line.refuse("--json needs --once");
  if (!options.trace.empty() && (options.once || !options.channel.empty()))
    return line.refuse("--trace goes with --seconds alone");
  if (!options.trace.empty()) return write_trace(options);
  EventLoop loop;  // blocks the signals before the bus starts its thread
  LcmBus bus(options.url);
  board::BusBoard board(options.channel);
  bus.tap([&](const std::string& channel, const void* data, int size,
              std::int64_t utime) { board.on_message(channel, data, static_cast<std::size_t>(size), utime); },
          {20'000});
  if (options.once) return show_once(bus, board, options);
  show_live(bus, board, loop);
  return 0;
}

}  // namespace curbstone::spy
