#include "services/viewer/web/web_server.hpp"

#include <utility>  // Beast 1.74 forgets it in C++20

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <optional>
#include <thread>

#include "common/time/clock.hpp"
#include "services/viewer/web/assets.hpp"
#include "services/viewer/web/host_rules.hpp"
#include "services/viewer/web/listening_socket.hpp"
#include "services/viewer/web/page_connection.hpp"

namespace curbstone::viewer::web {
namespace {

constexpr std::string_view kLive = "/live";  // of a page's WebSocket
constexpr std::string_view kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// An HTTP connection, until it is upgraded to a page's WebSocket.
class Visit final : public std::enable_shared_from_this<Visit> {
 public:
  Visit(tcp::socket socket, Shared& shared, Pages& pages, PageId id)
      : stream_(std::move(socket)),
        slot_(std::make_unique<ConnectionSlot>(shared)),
        shared_(shared),
        pages_(pages),
        id_(id) {}

  void read() {
    parser_.emplace();
    parser_->header_limit(shared_.settings.limits.head_bytes);
    parser_->body_limit(0);
    stream_.expires_after(shared_.settings.limits.head);
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error == http::error::end_of_stream || error == asio::error::operation_aborted) return;
      const bool said_something = self->buffer_.size() > 0 || self->parser_->got_some();
      if (error == beast::error::timeout && !said_something) return;
      if (error) return self->shared_.count("refused.request");
      self->answer();
    });
  }

 private:
  using Request = http::request<http::empty_body>;

  void answer() {
    const Request& request = parser_->get();
    const std::string host(request[http::field::host]);
    if (request.count(http::field::host) != 1 || !shared_.rules.allows_host(host)) {
      shared_.count("refused.host");
      return refuse(http::status::forbidden,
                    "This name is not one of the viewer's: viewer.names in the configuration.\n");
    }
    if (websocket::is_upgrade(request)) return watch(request, host);
    if (!shared_.settings.subprotocols.empty()) {
      shared_.count("refused.request");
      return refuse(http::status::upgrade_required, "A WebSocket, and nothing else.\n");
    }
    if (request.method() != http::verb::get && request.method() != http::verb::head) {
      shared_.count("refused.request");
      return refuse(http::status::method_not_allowed, "GET or HEAD.\n");
    }
    const std::string_view target(request.target().data(), request.target().size());
    const std::string_view path = target.substr(0, target.find('?'));
    if (path == kLive) return tell_why();
    const auto asset = find_asset(path, shared_.settings.folder);
    if (!asset) {
      shared_.count("refused.request");
      return refuse(http::status::not_found, "There is no such file.\n");
    }
    respond(http::status::ok, asset->type, asset->bytes);
  }

  /// To a page whose WebSocket was refused: a browser keeps that answer to itself.
  void tell_why() {
    if (pages_.size() >= shared_.settings.limits.pages)
      return refuse(http::status::service_unavailable, "Too many pages watch.\n");
    refuse(http::status::upgrade_required, "A WebSocket, and nothing else.\n");
  }

  void watch(const Request& request, const std::string& host) {
    const bool is_for_page = shared_.settings.subprotocols.empty();
    const std::string_view target(request.target().data(), request.target().size());
    if (is_for_page && target != kLive) {
      shared_.count("refused.request");
      return refuse(http::status::not_found, "There is no such file.\n");
    }
    if (is_for_page ? !is_own_page(request, host) : !is_known_program(request)) {
      shared_.count("refused.origin");
      return refuse(http::status::forbidden,
                    is_for_page ? "Only the viewer's own page may watch.\n" : "Pages of this origin may not watch.\n");
    }
    const std::string subprotocol = agreed_subprotocol(request);
    if (!is_for_page && subprotocol.empty()) {
      shared_.count("refused.request");
      return refuse(http::status::bad_request, "None of the subprotocols is known here.\n");
    }
    if (pages_.size() >= shared_.settings.limits.pages) {
      shared_.count("refused.pages");
      return refuse(http::status::service_unavailable, "Too many pages watch.\n");
    }
    stream_.expires_never();
    const auto page = std::make_shared<Page>(stream_.release_socket(), std::move(slot_), id_, shared_, pages_);
    pages_.emplace(id_, page);
    page->start(request, subprotocol);
  }

  [[nodiscard]] bool is_own_page(const Request& request, const std::string& host) const {
    const std::string origin(request[http::field::origin]);
    return request.count(http::field::origin) == 1 && shared_.rules.allows_origin(origin, host);
  }
  /// A browser always sends the page's origin; other programs need not.
  [[nodiscard]] bool is_known_program(const Request& request) const {
    const auto& origins = shared_.settings.origins;
    const std::string origin(request[http::field::origin]);
    return request.count(http::field::origin) == 0 ||
           (request.count(http::field::origin) == 1 &&
            std::find(origins.begin(), origins.end(), origin) != origins.end());
  }
  /// The first subprotocol offered that is known here; empty: none.
  [[nodiscard]] std::string agreed_subprotocol(const Request& request) const {
    const auto& known = shared_.settings.subprotocols;
    const std::string offer(request[http::field::sec_websocket_protocol]);
    for (const auto& token : http::token_list(offer)) {
      const std::string name(token);
      if (std::find(known.begin(), known.end(), name) != known.end()) return name;
    }
    return {};
  }

  void refuse(http::status status, std::string_view why) {
    closes_ = true;
    respond(status, "text/plain; charset=utf-8", std::string(why));
  }

  void respond(http::status status, const std::string& type, std::string bytes) {
    const Request& request = parser_->get();
    response_ = {};
    response_.version(request.version());
    response_.result(status);
    response_.set(http::field::content_type, type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("Content-Security-Policy", boost::string_view(kPolicy.data(), kPolicy.size()));
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    if (status == http::status::method_not_allowed) response_.set(http::field::allow, "GET, HEAD");
    response_.keep_alive(request.keep_alive() && !closes_);
    response_.content_length(bytes.size());
    if (request.method() != http::verb::head) response_.body() = std::move(bytes);
    stream_.expires_after(shared_.settings.limits.write);
    http::async_write(stream_, response_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error == beast::error::timeout) self->shared_.count("dropped.slow_page");
      if (error) return;
      if (self->response_.keep_alive()) return self->read();
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  beast::tcp_stream stream_;
  std::unique_ptr<ConnectionSlot> slot_;
  Shared& shared_;
  Pages& pages_;
  const PageId id_;
  beast::flat_buffer buffer_{16384};
  std::optional<http::request_parser<http::empty_body>> parser_;
  http::response<http::string_body> response_;
  bool closes_ = false;
};

HostRules rules_of(const WebSettings& settings) {
  std::vector<std::string> names = settings.names;
  const bool is_v6 = settings.address.find(':') != std::string::npos;
  names.push_back(is_v6 ? "[" + settings.address + "]" : settings.address);
  return HostRules(std::move(names));
}

}  // namespace

class WebServer::Impl {
 public:
  explicit Impl(const WebSettings& settings) : shared_(settings, rules_of(settings)), acceptor_(loop_) {
    try {
      listen();
    } catch (const NotFree& error) {
      if (!settings.waits) throw;
      listen_later(error.what());
    }
    thread_ = std::thread([this] { loop_.run(); });
  }
  ~Impl() {
    loop_.stop();
    thread_.join();
    pages_.clear();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] std::uint16_t port() {
    const std::scoped_lock lock(shared_.mutex);
    return port_;
  }

  std::string fault() {
    const std::scoped_lock lock(shared_.mutex);
    return fault_;
  }

  std::vector<Event> take_events() {
    const std::scoped_lock lock(shared_.mutex);
    return std::exchange(shared_.events, {});
  }

  void send(PageId id, Frame frame, bool is_text) {
    shared_.queue(id, frame->size());
    asio::post(loop_, [this, id, frame = std::move(frame), is_text]() mutable {
      const auto page = pages_.find(id);
      if (page == pages_.end()) return shared_.unqueue(id, frame->size());
      page->second->send(std::move(frame), is_text);
    });
  }

  std::size_t queued(PageId id) {
    const std::scoped_lock lock(shared_.mutex);
    const auto it = shared_.queued.find(id);
    return it == shared_.queued.end() ? 0 : it->second;
  }

  Counters counters() {
    const std::scoped_lock lock(shared_.mutex);
    return shared_.counters;
  }

 private:
  void listen() {
    const WebSettings& settings = shared_.settings;
    const int fd = open_listening_socket(settings.address, settings.port, settings.ports, settings.network);
    acceptor_.assign(settings.address.find(':') == std::string::npos ? tcp::v4() : tcp::v6(), fd);
    set_listening(port_of(fd), {});
    accept();
  }
  void listen_later(const std::string& why) {
    set_listening(0, why);
    pause_.expires_after(std::chrono::seconds(1));
    pause_.async_wait([this](error_code aborted) {
      if (aborted) return;
      try {
        listen();
      } catch (const std::runtime_error& error) {
        listen_later(error.what());
      }
    });
  }
  void set_listening(std::uint16_t port, std::string fault) {
    const std::scoped_lock lock(shared_.mutex);
    port_ = port;
    fault_ = std::move(fault);
  }
  void accept() {
    acceptor_.async_accept([this](error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error) greet(std::move(socket));
      if (error) return rest();  // for example no descriptors left
      accept();
    });
  }
  void rest() {
    shared_.count("refused.connections");
    pause_.expires_after(std::chrono::milliseconds(100));
    pause_.async_wait([this](error_code error) {
      if (!error) accept();
    });
  }
  void greet(tcp::socket socket) {
    if (shared_.connections >= shared_.settings.limits.connections) return shared_.count("refused.connections");
    error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    std::make_shared<Visit>(std::move(socket), shared_, pages_, ++last_id_)->read();
  }

  Shared shared_;
  Pages pages_;  // used by the web thread only
  PageId last_id_ = 0;
  std::uint16_t port_ = 0;  // this and the next: guarded by shared_.mutex
  std::string fault_;
  asio::io_context loop_{1};
  asio::steady_timer pause_{loop_};
  tcp::acceptor acceptor_;
  std::thread thread_;
};

WebServer::WebServer(const WebSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
WebServer::~WebServer() = default;

std::uint16_t WebServer::port() const {
  return impl_->port();
}

std::string WebServer::fault() const {
  return impl_->fault();
}

std::vector<Connections::Event> WebServer::take_events() {
  return impl_->take_events();
}

void WebServer::send(PageId page, Frame frame) {
  impl_->send(page, std::move(frame), false);
}

void WebServer::send_text(PageId page, std::string text) {
  impl_->send(page, std::make_shared<const std::vector<std::uint8_t>>(text.begin(), text.end()), true);
}

std::size_t WebServer::queued(PageId page) const {
  return impl_->queued(page);
}

Counters WebServer::counters() const {
  return impl_->counters();
}

}  // namespace curbstone::viewer::web
