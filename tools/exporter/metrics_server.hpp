#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace curbstone::exporter {

/// The address of the server and the host names under which it answers.
struct ServerAddress {
  std::string address = "127.0.0.1";
  int port = 0;                    ///< 0: any free port
  std::vector<std::string> names;  ///< of this host, in addition to the address and localhost
};

/// Serves GET /metrics over HTTP, in its own threads. At most two requests are answered at a time, one request per
/// connection; a client that is silent for two seconds is disconnected.
class MetricsServer {
 public:
  /// `metrics` is called from the server's threads. Throws std::runtime_error if the port cannot be opened.
  MetricsServer(const ServerAddress& address, std::function<std::string()> metrics);
  ~MetricsServer();
  MetricsServer(const MetricsServer&) = delete;
  MetricsServer& operator=(const MetricsServer&) = delete;

  [[nodiscard]] int port() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace curbstone::exporter
