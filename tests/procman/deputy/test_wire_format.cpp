#include <gmock/gmock.h>

#include <procman_lcm/cmd_desired_t.hpp>
#include <procman_lcm/cmd_status_t.hpp>
#include <procman_lcm/cmd_t.hpp>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <procman_lcm/output_t.hpp>

#include "common/bus/decode.hpp"
#include "common/bus/local_bus.hpp"
#include "procman/deputy/deputy.hpp"
#include "procman/sheriff/sheriff.hpp"
#include "tests/procman/golden_bytes.hpp"
#include "tests/procman/process/supervised.hpp"

namespace curbstone::procman {
namespace {

using golden::bytes_of;
using golden::hex_of;
using golden::kUtime;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

template <class Message>
std::uint64_t fingerprint() {
  return static_cast<std::uint64_t>(Message::getHash());
}

template <class Message>
std::string encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  EXPECT_EQ(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  return hex_of(bytes);
}

template <class Message>
Message decoded(std::string_view hex) {
  const std::vector<std::uint8_t> bytes = bytes_of(hex);
  Message message{};
  EXPECT_TRUE(decode(bytes.data(), static_cast<int>(bytes.size()), message));
  return message;
}

procman_lcm::cmd_t mapper() {
  procman_lcm::cmd_t cmd{};
  cmd.command_id = "mapper";
  cmd.exec_str = "sleep 60";
  cmd.group = "map";
  cmd.auto_respawn = 1;
  cmd.stop_signal = 15;
  cmd.stop_time_allowed = 2.5F;
  return cmd;
}

procman_lcm::cmd_t ekf() {
  procman_lcm::cmd_t cmd{};
  cmd.command_id = "ekf";
  cmd.exec_str = "true";
  cmd.stop_signal = 2;
  cmd.stop_time_allowed = 7.0F;
  return cmd;
}

procman_lcm::cmd_status_t running_mapper() {
  procman_lcm::cmd_status_t status{};
  status.cmd = mapper();
  status.pid = 4711;
  status.actual_runid = 3;
  status.cpu_usage = 0.25F;
  status.mem_vsize_bytes = std::int64_t{1} << 32;
  status.mem_rss_bytes = 12345678;
  return status;
}

procman_lcm::cmd_status_t failed_ekf() {
  procman_lcm::cmd_status_t status{};
  status.cmd = ekf();
  status.actual_runid = 1;
  status.exit_code = 0x300;
  return status;
}

procman_lcm::deputy_info_t info() {
  procman_lcm::deputy_info_t info{};
  info.utime = kUtime;
  info.deputy_id = "ugv";
  info.cpu_load = 0.5F;
  info.phys_mem_total_bytes = std::int64_t{8} << 30;
  info.phys_mem_free_bytes = std::int64_t{3} << 30;
  info.swap_total_bytes = -1;
  info.cmds = {failed_ekf(), running_mapper()};
  info.ncmds = 2;
  return info;
}

void expect_mapper(const procman_lcm::cmd_t& cmd) {
  EXPECT_EQ(cmd.command_id, "mapper");
  EXPECT_EQ(cmd.exec_str, "sleep 60");
  EXPECT_EQ(cmd.group, "map");
  EXPECT_EQ(cmd.auto_respawn, 1);
  EXPECT_EQ(cmd.stop_signal, 15);
  EXPECT_EQ(cmd.stop_time_allowed, 2.5F);
}

void expect_running_mapper(const procman_lcm::cmd_status_t& status) {
  expect_mapper(status.cmd);
  EXPECT_EQ(status.pid, 4711);
  EXPECT_EQ(status.actual_runid, 3);
  EXPECT_EQ(status.exit_code, 0);
  EXPECT_EQ(status.cpu_usage, 0.25F);
  EXPECT_EQ(status.mem_vsize_bytes, std::int64_t{1} << 32);
  EXPECT_EQ(status.mem_rss_bytes, 12345678);
}

/// Computed by Debian's lcm-gen 1.3.1 from procman's own definitions: field order and types decide.
TEST(ProcmanTypes, HaveTheFingerprintsOfTheUpstreamWireFormat) {
  EXPECT_EQ(fingerprint<procman_lcm::cmd_t>(), 0x2277f449a855d330U);
  EXPECT_EQ(fingerprint<procman_lcm::cmd_desired_t>(), 0xb2a6c7a09ba54539U);
  EXPECT_EQ(fingerprint<procman_lcm::cmd_status_t>(), 0xa8e0208786cf86e3U);
  EXPECT_EQ(fingerprint<procman_lcm::deputy_info_t>(), 0x8876aeb040efd01fU);
  EXPECT_EQ(fingerprint<procman_lcm::orders_t>(), 0xd343f45b171ab855U);
  EXPECT_EQ(fingerprint<procman_lcm::output_t>(), 0x8efa5caf5da01eb3U);
  EXPECT_EQ(fingerprint<procman_lcm::discovery_t>(), 0xb1c83182bed74b95U);
}

TEST(ProcmanTypes, ACommandIsTheseBytes) {
  EXPECT_EQ(encoded(mapper()), golden::kCmd);
  expect_mapper(decoded<procman_lcm::cmd_t>(golden::kCmd));
}

TEST(ProcmanTypes, ADesiredCommandIsTheseBytes) {
  EXPECT_EQ(encoded(procman_lcm::cmd_desired_t{mapper(), 3, 1}), golden::kDesired);
  const auto desired = decoded<procman_lcm::cmd_desired_t>(golden::kDesired);
  expect_mapper(desired.cmd);
  EXPECT_EQ(desired.desired_runid, 3);
  EXPECT_EQ(desired.force_quit, 1);
}

TEST(ProcmanTypes, ACommandsStatusIsTheseBytes) {
  EXPECT_EQ(encoded(running_mapper()), golden::kStatus);
  expect_running_mapper(decoded<procman_lcm::cmd_status_t>(golden::kStatus));
}

TEST(ProcmanTypes, ADeputysReportIsTheseBytes) {
  EXPECT_EQ(encoded(info()), golden::kInfo);
  const auto report = decoded<procman_lcm::deputy_info_t>(golden::kInfo);
  EXPECT_EQ(report.utime, kUtime);
  EXPECT_EQ(report.deputy_id, "ugv");
  EXPECT_EQ(report.cpu_load, 0.5F);
  EXPECT_EQ(report.phys_mem_total_bytes, std::int64_t{8} << 30);
  EXPECT_EQ(report.phys_mem_free_bytes, std::int64_t{3} << 30);
  EXPECT_EQ(report.swap_total_bytes, -1);
  EXPECT_EQ(report.swap_free_bytes, 0);
  ASSERT_EQ(report.cmds.size(), 2U);
  EXPECT_EQ(report.cmds[0].cmd.command_id, "ekf");
  EXPECT_EQ(report.cmds[0].cmd.group, "");
  EXPECT_EQ(report.cmds[0].exit_code, 0x300);
  expect_running_mapper(report.cmds[1]);
}

TEST(ProcmanTypes, OrdersAreTheseBytes) {
  procman_lcm::orders_t orders{};
  orders.utime = kUtime;
  orders.deputy_id = "ugv";
  orders.sheriff_id = "host:12:34";
  orders.cmds = {{ekf(), 2, 0}, {mapper(), 3, 0}};
  orders.ncmds = 2;
  EXPECT_EQ(encoded(orders), golden::kOrders);
  const auto read = decoded<procman_lcm::orders_t>(golden::kOrders);
  EXPECT_EQ(read.utime, kUtime);
  EXPECT_EQ(read.deputy_id, "ugv");
  EXPECT_EQ(read.sheriff_id, "host:12:34");
  ASSERT_EQ(read.cmds.size(), 2U);
  EXPECT_EQ(read.cmds[0].cmd.exec_str, "true");
  EXPECT_EQ(read.cmds[0].desired_runid, 2);
  expect_mapper(read.cmds[1].cmd);
  EXPECT_EQ(read.cmds[1].desired_runid, 3);
}

TEST(ProcmanTypes, OutputIsTheseBytes) {
  procman_lcm::output_t output{};
  output.utime = kUtime;
  output.deputy_id = "ugv";
  output.command_ids = {"mapper", ""};
  output.text = {"ready\r\n", "Killed\n"};
  output.num_commands = 2;
  EXPECT_EQ(encoded(output), golden::kOutput);
  const auto read = decoded<procman_lcm::output_t>(golden::kOutput);
  EXPECT_EQ(read.utime, kUtime);
  EXPECT_EQ(read.deputy_id, "ugv");
  EXPECT_THAT(read.command_ids, ElementsAre("mapper", ""));
  EXPECT_THAT(read.text, ElementsAre("ready\r\n", "Killed\n"));
}

TEST(ProcmanTypes, DiscoveryIsTheseBytes) {
  EXPECT_EQ(encoded(procman_lcm::discovery_t{kUtime, "ugv", 4711}), golden::kDiscovery);
  const auto read = decoded<procman_lcm::discovery_t>(golden::kDiscovery);
  EXPECT_EQ(read.utime, kUtime);
  EXPECT_EQ(read.transmitter_id, "ugv");
  EXPECT_EQ(read.nonce, 4711);
}

TEST(ProcmanWire, TheSheriffReadsAReportAndWritesOrdersByteForByte) {
  sheriff::Sheriff sheriff("host:12:34");
  sheriff.on(decoded<procman_lcm::deputy_info_t>(golden::kInfo), kUtime);
  EXPECT_EQ(sheriff::describe(sheriff.commands().at("mapper").status), "running");
  EXPECT_THAT(sheriff::describe(sheriff.commands().at("ekf").status), HasSubstr("exit status 3"));
  sheriff.start("ekf");
  const auto orders = sheriff.orders("ugv", kUtime);
  ASSERT_TRUE(orders);
  EXPECT_EQ(encoded(*orders), golden::kOrders);
}

TEST(ProcmanWire, TheDeputyObeysOrdersThatCameAsBytesAndReportsInProcmansLayout) {
  process::Supervised s;
  LocalBus bus;
  std::string report;
  bus.tap([&](const std::string& channel, const void* data, int size, std::int64_t) {
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    if (channel == "PM_INFO") report = hex_of({bytes, bytes + size});
  });
  deputy::Deputy deputy({.id = "ugv", .allow_list = {}, .discovery_window = 10'000}, s.supervisor, bus);
  deputy.connect(bus);
  s.on_output = [&](const std::string& id, std::string_view bytes) { deputy.output(id, bytes); };
  s.tick = [&] {
    deputy.tick();
    bus.dispatch();
  };
  ASSERT_TRUE(s.run_until([&] { return deputy.active(); }));

  std::vector<std::uint8_t> orders = bytes_of(golden::kOrders);
  const std::int64_t now = wall_clock();
  for (std::size_t i = 0; i < 8; ++i) orders[8 + i] = static_cast<std::uint8_t>(now >> (56 - 8 * i));  // not stale
  bus.inject("PM_ORDERS", orders.data(), static_cast<int>(orders.size()));
  bus.dispatch();

  const process::CommandState* const state = s.supervisor.find("mapper");
  ASSERT_NE(state, nullptr);
  EXPECT_GT(state->pid, 0);
  EXPECT_TRUE(state->command.auto_respawn);
  EXPECT_EQ(state->command.stop_signal, 15);
  EXPECT_EQ(state->command.group, "map");
  const std::string mapper_without_fingerprint(golden::kCmd.substr(16));
  ASSERT_TRUE(s.run_until([&] { return report.find(mapper_without_fingerprint) != std::string::npos; }));
  EXPECT_THAT(report, StartsWith("8876aeb040efd01f"));
  char pid[9] = {};
  std::snprintf(pid, sizeof pid, "%08x", static_cast<unsigned>(state->pid));
  EXPECT_THAT(report, HasSubstr(mapper_without_fingerprint + pid + "00000003")) << "the command, its pid, its run id";
}

}  // namespace
}  // namespace curbstone::procman
