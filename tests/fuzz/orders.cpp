// What a sheriff, or anybody, sends to a deputy that has an allow-list: PM_ORDERS, PM_INFO and PM_DISCOVER of any
// bytes. Nothing may be started. Input, repeated: channel (1 byte), length (2 bytes), message without its fingerprint.
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/shell/event_loop.hpp"
#include "procman/deputy/deputy.hpp"
#include "tests/fuzz/support/input.hpp"
#include "tests/fuzz/support/message.hpp"
#include "tests/fuzz/support/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  static EventLoop loop;  // SIGCHLD is blocked once
  static int started = 0;
  procman::process::Supervisor supervisor(loop, {.output = [](const std::string&, std::string_view) {},
                                                 .started = [](const auto&) { ++started; },
                                                 .ended = [](const auto&, std::int64_t) {}});
  LocalBus bus;
  procman::deputy::DeputyOptions options;
  options.id = "vehicle";
  options.allow_list = procman::config::Config{};
  options.discovery_window = 0;
  procman::deputy::Deputy deputy(options, supervisor, bus);
  deputy.connect(bus);
  deputy.tick();
  for (fuzz::Input input(data, size); !input.empty();) {
    const auto channel = input.number<std::uint8_t>() % 3;
    const fuzz::Bytes body = input.piece();
    if (channel == 0) fuzz::inject<procman_lcm::orders_t>(bus, "PM_ORDERS", body);
    if (channel == 1) fuzz::inject<procman_lcm::deputy_info_t>(bus, "PM_INFO", body);
    if (channel == 2) fuzz::inject<procman_lcm::discovery_t>(bus, "PM_DISCOVER", body);
    bus.dispatch();
    deputy.tick();
    bus.dispatch();
  }
  deputy.flush();
  fuzz::require(started == 0, "nothing runs that is not on the allow-list");
  return 0;
}
