#include <fmt/format.h>
#include <sys/resource.h>

#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "common/bus/lcm_bus.hpp"
#include "common/config/command_line.hpp"
#include "common/shell/event_loop.hpp"
#include "common/shell/status_reporter.hpp"
#include "common/time/clock.hpp"
#include "common/time/retry_backoff.hpp"
#include "tools/exporter/metrics_server.hpp"
#include "tools/exporter/metrics_text.hpp"
#include "tools/spy/board/bus_board.hpp"

namespace {

using namespace curbstone;  // NOLINT(google-build-using-namespace): this file is a program

/// Each client uses a descriptor; further ones wait in the kernel's queue.
void limit_clients() {
  constexpr rlimit kDescriptors{64, 64};
  setrlimit(RLIMIT_NOFILE, &kDescriptors);
}

void run_exporter(const std::string& url, const exporter::ServerAddress& address) {
  limit_clients();
  EventLoop loop;  // blocks the signals before there are threads
  LcmBus bus(url, LcmBus::WithoutRoute::kWait);
  std::mutex mutex;
  spy::board::BusBoard board("");
  bus.tap(
      [&](const std::string& channel, const void* data, int size, std::int64_t utime) {
        const std::scoped_lock lock(mutex);
        board.on_message(channel, data, static_cast<std::size_t>(size), utime);
      },
      {20'000});
  StatusReporter reporter("exporter", "");
  NodeReport report;
  RetryBackoff retry;
  std::unique_ptr<exporter::MetricsServer> server;
  const auto with_bus = [&] {
    NodeReport all = report;
    if (auto fault = bus.fault()) all.faults.push_back(std::move(*fault));
    return all;
  };
  const auto listen = [&] {
    if (server || !retry.due(steady_clock())) return;
    try {
      server = std::make_unique<exporter::MetricsServer>(address, [&] {
        const std::scoped_lock lock(mutex);
        return exporter::metrics_text(board, wall_clock());
      });
      report.faults.clear();
      fmt::print(stderr, "exporter: http://{}:{}/metrics\n", address.address, server->port());
    } catch (const std::runtime_error& error) {
      report.faults = {error.what()};
      retry.failed(steady_clock());
    }
    if (reporter.faults_changed(with_bus())) reporter.publish(bus, bus.counters(), with_bus());
  };
  listen();
  loop.every(std::chrono::milliseconds(100), listen);
  loop.every(std::chrono::milliseconds(1000), [&] { reporter.publish(bus, bus.counters(), with_bus()); });
  loop.watch(bus.fd(), [&] { bus.handle(std::chrono::milliseconds(0)); });
  loop.run();
}

}  // namespace

int main(int argc, char** argv) {
  std::string url;
  exporter::ServerAddress address;
  address.port = 9750;
  CommandLine line("Rates of the channels, counters of the services and the deputies' processes, for Prometheus",
                   "curbstone-exporter");
  line.option("--lcm-url", url, "Bus; default $LCM_DEFAULT_URL, else loopback");
  line.option("--listen", address.address, "Address to listen on; there is no password").shows_default();
  line.option("--port", address.port, "TCP port; 0: any").within(0, 65535).shows_default();
  line.option("--name", address.names, "A name by which this host may be asked, besides its address").one_each();
  if (const auto status = line.read(argc, argv)) return *status;
  try {
    run_exporter(url, address);
  } catch (const std::exception& error) {
    fmt::print(stderr, "exporter: {}\n", error.what());
    return 1;
  }
  return 0;
}
