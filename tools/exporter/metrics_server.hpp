#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace curbstone::exporter {

/// Where the server listens, and by what names it may be asked.
struct ServerAddress {
  std::string address = "127.0.0.1";
  int port = 0;                    ///< 0: any that is free
  std::vector<std::string> names;  ///< of this host, besides the address and localhost
};

/// GET /metrics over HTTP, in threads of its own. At most two requests are answered at a time, each connection for one
/// request, and whoever says nothing for two seconds is dropped.
class MetricsServer {
 public:
  /// `metrics` is called from the server's threads. Throws std::runtime_error if the port cannot be had.
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
