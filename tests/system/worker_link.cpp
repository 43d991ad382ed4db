#include "tests/system/worker_link.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstring>
#include <curbstone/tile_request_t.hpp>
#include <curbstone/voted_points_t.hpp>

#include "tests/temporary_folder.hpp"

namespace curbstone::system_test {

namespace {

/// Bytes that are a message already.
struct EncodedMessage {
  const void* data;
  int size;
  [[nodiscard]] int getEncodedSize() const { return size; }
  int encode(void* buffer, int offset, int /*max*/) const {
    std::memcpy(static_cast<char*>(buffer) + offset, data, static_cast<std::size_t>(size));
    return size;
  }
};

}  // namespace

WorkerLink::WorkerLink(int port, double loss, unsigned seed, LocalBus& local, const test::TemporaryFolder& folder)
    : url_(fmt::format("udpm://239.255.76.67:{}?ttl=0&recv_buf_size=4194304", port)),
      bus_(url_),
      loss_(loss),
      random_(seed),
      folder_(folder) {
  // The bus also brings back what was sent there: only what the link's own workers say is taken.
  bus_.subscribe<voted_points_t>("VOTED_POINTS", [this, &local](const voted_points_t& m) {
    if (!loses()) local.publish("VOTED_POINTS", m);
  });
  bus_.subscribe<tile_request_t>("TILE_REQUEST", [this, &local](const tile_request_t& m) {
    if (workers_.contains(m.requester) && !loses()) local.publish("TILE_REQUEST", m);
  });
  bus_.subscribe<tile_index_t>("TILE_INDEX", [this, &local](const tile_index_t& m) {
    if (!workers_.contains(m.owner) || loses()) return;
    local.publish("TILE_INDEX", m);
    if (heartbeat) heartbeat(m);
  });
  bus_.subscribe<service_status_t>("SERVICE_STATUS", [this](const service_status_t& m) { statuses[m.service] = m; });
}

bool WorkerLink::loses() {
  const bool lost_now = std::uniform_real_distribution<double>(0, 1)(random_) < loss_;
  lost += lost_now ? 1 : 0;
  return lost_now;
}

void WorkerLink::start(const std::string& worker, const std::string& prefix) {
  killed_.erase(worker);
  workers_[worker] = std::make_unique<BackgroundProgram>(
      fmt::format("{}curbstone-tensor-voting --name {} --lcm-url '{}' --set bandwidth=20", prefix, worker, url_),
      folder_ / (worker + ".out"));
}

void WorkerLink::kill(const std::string& worker) {
  workers_.at(worker)->send_signal(SIGKILL);
  workers_.at(worker)->wait(5);
  killed_.insert(worker);
}

bool WorkerLink::all_live() {
  for (const auto& [name, program] : workers_) {
    if (killed_.contains(name) || program->running()) continue;
    ADD_FAILURE() << name << " ended with " << program->wait(0) << ": " << program->output();
    return false;
  }
  return true;
}

void WorkerLink::send(const std::string& channel, const void* data, int size) {
  if (!loses()) bus_.publish(channel, EncodedMessage{data, size});
}

}  // namespace curbstone::system_test
