#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "services/viewer/web/connections.hpp"

namespace curbstone::viewer::web {

/// Limits for a browser or any other client. A client that exceeds one is disconnected and counted.
struct WebLimits {
  std::size_t pages = 8;                     ///< connected at a time
  std::size_t connections = 48;              ///< of any kind
  std::uint32_t head_bytes = 8192;           ///< of a request
  std::size_t message_bytes = 4096;          ///< of one message of a page
  std::size_t frames = 8;                    ///< queued for a page; an acknowledging page has at most two
  std::size_t messages_per_second = 50;      ///< per page
  std::chrono::milliseconds head{5000};      ///< to receive a complete request, and to wait for the next one
  std::chrono::milliseconds silence{20000};  ///< of a page, pings included
  std::chrono::milliseconds write{10000};    ///< to send a response or a frame
};

/// zlib level of the messages to a browser (permessage-deflate, RFC 7692); each message is compressed by itself.
inline constexpr int kCompression = 1;

struct WebSettings {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;          ///< 0: any free port
  int ports = 1;                   ///< to try, from `port` on
  bool waits = false;              ///< for a port that is not free: see WebServer::fault()
  std::string network;             ///< see open_listening_socket()
  std::vector<std::string> names;  ///< see HostRules
  std::string folder;              ///< see find_asset()
  /// Not empty: serves no page, but only a WebSocket, to programs that speak one of these protocols and to pages from
  /// `origins` ("https://app.example.org").
  std::vector<std::string> subprotocols;
  std::vector<std::string> origins;
  WebLimits limits;
};

/// Serves the page (GET and HEAD of its files) and its WebSocket, /live. Read-only: a page's messages change only what
/// is sent to that page. It runs in its own thread, so a slow browser delays nothing else.
///
/// Counters: pages.came, pages.bytes (before compression); refused.host, .origin, .request (no such file, method or
/// head), .pages, .connections (too many), .messages (too many or too large); dropped.slow_page (a frame or a response
/// was not sent in time), dropped.frames.
class WebServer final : public Connections {
 public:
  /// Listens once constructed. Throws std::runtime_error with a one-line message; with `waits` not for a port that is
  /// taken or an address that no interface has: these are tried again each second.
  explicit WebServer(const WebSettings& settings);
  ~WebServer() override;

  /// 0 while it waits.
  [[nodiscard]] std::uint16_t port() const;
  /// What it waits for, in one line; empty: it listens.
  [[nodiscard]] std::string fault() const;
  [[nodiscard]] std::vector<Event> take_events() override;
  void send(PageId page, Frame frame) override;
  void send_text(PageId page, std::string text) override;
  [[nodiscard]] std::size_t queued(PageId page) const override;
  [[nodiscard]] Counters counters() const override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace curbstone::viewer::web
