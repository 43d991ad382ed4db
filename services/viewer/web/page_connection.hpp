#pragma once

#include <utility>  // Beast 1.74 forgets it in C++20

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <limits>
#include <map>
#include <memory>

#include "common/time/clock.hpp"
#include "services/viewer/web/shared.hpp"

/// Part of web_server.cpp; no other file includes it, because Beast takes most of a minute to compile.
namespace curbstone::viewer::web {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using boost::system::error_code;

class Page;
using Pages = std::map<PageId, std::shared_ptr<Page>>;

/// The WebSocket connection of a page.
class Page final : public std::enable_shared_from_this<Page> {
 public:
  Page(tcp::socket socket, std::unique_ptr<ConnectionSlot> slot, PageId id, Shared& shared, Pages& pages)
      : stream_(std::move(socket)),
        write_timer_(stream_.get_executor()),
        slot_(std::move(slot)),
        id_(id),
        shared_(shared),
        pages_(pages) {}

  /// `subprotocol`: the one agreed on; empty: none.
  void start(const http::request<http::empty_body>& request, const std::string& subprotocol) {
    const WebLimits& limits = shared_.settings.limits;
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = limits.head;
    timeout.idle_timeout = limits.silence;
    timeout.keep_alive_pings = true;
    stream_.set_option(timeout);
    stream_.read_message_max(0);  // see read()
    stream_.auto_fragment(false);
    if (subprotocol.empty()) compress();
    if (!subprotocol.empty()) {
      stream_.set_option(websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
        response.set(http::field::sec_websocket_protocol, subprotocol);
      }));
    }
    stream_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (error) return self->leave();
      self->is_open_ = true;
      self->shared_.count("pages.came");
      self->shared_.post_event({self->id_, Connections::Event::Kind::kConnected, "", wall_clock()});
      self->read();
    });
  }

  void send(Frame frame, bool is_text) {
    if (!is_open_ || queue_.size() >= shared_.settings.limits.frames) {
      shared_.unqueue(id_, frame->size());
      if (is_open_) shared_.count("dropped.frames");
      return;
    }
    queue_.push_back({std::move(frame), is_text});
    if (queue_.size() == 1) write();
  }

 private:
  /// Compresses messages to a third of their size (docs/benchmarks/viewer.md). Each message is compressed by itself:
  /// that costs a little, but needs no compression state per page. Clients that speak a subprotocol only read
  /// uncompressed messages.
  void compress() {
    websocket::permessage_deflate option;
    option.server_enable = true;
    option.server_no_context_takeover = option.client_no_context_takeover = true;
    option.compLevel = kCompression;
    option.memLevel = 8;
    stream_.set_option(option);
    stream_.write_buffer_bytes(std::size_t{64} * 1024);
  }

  /// Reads a message in pieces and checks its size here: Beast's own limit would send a close frame for a message that
  /// is too big and wait for the peer's.
  void read() {
    const std::size_t room = shared_.settings.limits.message_bytes + 1 - buffer_.size();
    stream_.async_read_some(buffer_, room, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->leave();
      if (self->buffer_.size() > self->shared_.settings.limits.message_bytes) {
        self->shared_.count("refused.messages");
        return self->leave();
      }
      if (!self->stream_.is_message_done()) return self->read();
      self->receive();
    });
  }

  void receive() {
    const std::int64_t now = steady_clock();
    if (now - second_ >= 1'000'000) {
      second_ = now;
      messages_this_second_ = 0;
    }
    Connections::Event event{id_, Connections::Event::Kind::kMessage, beast::buffers_to_string(buffer_.data()),
                             wall_clock()};
    buffer_.consume(buffer_.size());
    if (++messages_this_second_ > shared_.settings.limits.messages_per_second ||
        !shared_.post_event(std::move(event))) {
      shared_.count("refused.messages");
      return leave();
    }
    read();
  }

  void write() {
    write_timer_.expires_after(shared_.settings.limits.write);
    write_timer_.async_wait([self = shared_from_this()](error_code error) {
      if (error) return;
      self->shared_.count("dropped.slow_page");
      self->leave();
    });
    stream_.text(queue_.front().is_text);
    stream_.async_write(asio::buffer(*queue_.front().frame),
                        [self = shared_from_this()](error_code error, std::size_t n) {
                          self->write_timer_.cancel();
                          if (error) return self->leave();
                          self->shared_.count("pages.bytes", static_cast<std::int64_t>(n));
                          self->shared_.unqueue(self->id_, self->queue_.front().frame->size());
                          self->queue_.pop_front();
                          if (!self->queue_.empty()) self->write();
                        });
  }

  void leave() {
    error_code ignored;
    beast::get_lowest_layer(stream_).socket().close(ignored);
    write_timer_.cancel();
    if (is_open_) shared_.post_event({id_, Connections::Event::Kind::kDisconnected, "", wall_clock()});
    is_open_ = false;
    shared_.unqueue(id_, std::numeric_limits<std::size_t>::max());
    pages_.erase(id_);
  }

  struct Outgoing {
    Frame frame;
    bool is_text;
  };
  websocket::stream<beast::tcp_stream> stream_;
  asio::steady_timer write_timer_;
  std::unique_ptr<ConnectionSlot> slot_;
  const PageId id_;
  Shared& shared_;
  Pages& pages_;
  beast::flat_buffer buffer_;
  std::deque<Outgoing> queue_;
  bool is_open_ = false;
  std::int64_t second_ = 0;  // us, steady clock: start of the present one-second window
  std::size_t messages_this_second_ = 0;
};

}  // namespace curbstone::viewer::web
