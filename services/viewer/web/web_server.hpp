#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "services/viewer/web/audience.hpp"

namespace curbstone::viewer::web {

/// What a browser, or who pretends to be one, may take. Whoever exceeds them is disconnected and counted.
struct WebLimits {
  std::size_t pages = 8;                     ///< that watch at a time
  std::size_t connections = 48;              ///< of any kind
  std::uint32_t head_bytes = 8192;           ///< of a request
  std::size_t message_bytes = 4096;          ///< that a page says at once
  std::size_t frames = 8;                    ///< that wait for a page; one that acknowledges has two
  std::size_t messages_per_second = 50;      ///< of a page
  std::chrono::milliseconds head{5000};      ///< for a request to be complete, and for the next one to begin
  std::chrono::milliseconds silence{20000};  ///< of a page, pings included
  std::chrono::milliseconds write{10000};    ///< for a response or a frame to be taken
};

/// zlib's level of the messages to a browser (permessage-deflate, RFC 7692), each by itself.
inline constexpr int kCompression = 1;

struct WebSettings {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;          ///< 0: any that is free
  int ports = 1;                   ///< to try, from `port` on
  std::string network;             ///< see open_listening_socket()
  std::vector<std::string> names;  ///< see HostRules
  std::string folder;              ///< see find_asset()
  /// Not empty: no page is served but a WebSocket alone, for programs that speak one of these protocols, and pages of
  /// `origins` ("https://app.example.org").
  std::vector<std::string> subprotocols;
  std::vector<std::string> origins;
  WebLimits limits;
};

/// Serves the page (GET and HEAD of its files) and its WebSocket, /live. Read-only: nothing that a page says changes
/// anything but what it is sent. A thread of its own does all of it, so that a slow browser delays nobody.
///
/// Counters: pages.came, pages.bytes (before they were compressed); refused.host, .origin, .request (no such
/// file, method or head), .pages, .connections (too many), .messages (too many or too large); dropped.slow_page (a
/// frame or an answer that was not taken in time), dropped.frames.
class WebServer final : public Audience {
 public:
  /// Listens from here on. Throws std::runtime_error with one clear line.
  explicit WebServer(const WebSettings& settings);
  ~WebServer() override;

  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] std::vector<Event> take_events() override;
  void send(PageId page, Frame frame) override;
  void say(PageId page, std::string text) override;
  [[nodiscard]] std::size_t queued(PageId page) const override;
  [[nodiscard]] Counters counters() const override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace curbstone::viewer::web
