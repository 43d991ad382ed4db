#include "tools/exporter/metrics_server.hpp"

#include <fmt/format.h>
#include <httplib.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "services/viewer/web/host_rules.hpp"

namespace curbstone::exporter {

namespace {

viewer::web::HostRules rules_of(const ServerAddress& address) {
  std::vector<std::string> names = address.names;
  names.push_back(address.address);
  return viewer::web::HostRules(names);
}

}  // namespace

class MetricsServer::Impl {
 public:
  Impl(const ServerAddress& address, std::function<std::string()> metrics) {
    server_.new_task_queue = [] { return new httplib::ThreadPool(2); };  // the server deletes it
    // Without SO_REUSEPORT, which is the library's default: two servers would take turns.
    server_.set_socket_options([](socket_t socket) {
      const int on = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    });
    server_.set_keep_alive_max_count(1);
    server_.set_read_timeout(2);
    server_.set_write_timeout(2);
    server_.set_payload_max_length(1024);
    server_.set_pre_routing_handler(
        [rules = rules_of(address)](const httplib::Request& request, httplib::Response& response) {
          if (rules.allows_host(request.get_header_value("Host"))) return httplib::Server::HandlerResponse::Unhandled;
          response.status = 403;
          response.set_content("not a name of this host: --name allows it\n", "text/plain");
          return httplib::Server::HandlerResponse::Handled;
        });
    server_.Get("/metrics", [metrics = std::move(metrics)](const httplib::Request&, httplib::Response& response) {
      response.set_content(metrics(), "text/plain; version=0.0.4; charset=utf-8");
    });
    port_ = address.port;
    const bool bound = port_ != 0 ? server_.bind_to_port(address.address, port_)
                                  : (port_ = server_.bind_to_any_port(address.address)) > 0;
    if (!bound) {
      throw std::runtime_error(
          fmt::format("cannot listen at {0}:{1}: the address is not of this host, or another process has the port "
                      "(ss -tlpn 'sport = :{1}' shows it)",
                      address.address, address.port));
    }
    thread_ = std::thread([this] {
      server_.listen_after_bind();
      ended_ = true;
    });
    // stop() has no effect before the server runs.
    while (!server_.is_running() && !ended_) std::this_thread::yield();
  }
  ~Impl() {
    server_.stop();
    thread_.join();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] int port() const { return port_; }

 private:
  httplib::Server server_;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
  int port_ = 0;
};

MetricsServer::MetricsServer(const ServerAddress& address, std::function<std::string()> metrics)
    : impl_(std::make_unique<Impl>(address, std::move(metrics))) {}
MetricsServer::~MetricsServer() = default;

int MetricsServer::port() const {
  return impl_->port();
}

}  // namespace curbstone::exporter
