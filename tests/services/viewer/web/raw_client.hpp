#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace curbstone::viewer::web {

/// A TCP connection to a server on this machine that says whatever bytes it likes: what a browser would never do.
class RawClient {
 public:
  explicit RawClient(std::uint16_t port);
  ~RawClient();
  RawClient(RawClient&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  /// False: the server has closed the connection.
  bool send_bytes(std::string_view bytes);
  /// What comes until the server closes the connection, or nothing came for `quiet` ms: for who asks again.
  std::string receive(int quiet);
  /// A whole HTTP answer, with as many bytes behind its head as that says; less if the server closes the connection, or
  /// nothing came for a minute.
  std::string receive_answer(bool with_body = true);
  /// A whole WebSocket frame, likewise.
  std::string receive_frame();
  /// Waits until the server closes, at most `seconds`; what it says meanwhile is dropped.
  bool is_closed_within(double seconds);
  void shrink_receive_buffer();

  /// Opens a page's WebSocket; the head of the answer.
  std::string upgrade(const std::string& host, const std::string& origin, const std::string& target = "/live",
                      const std::string& extensions = "");
  /// A text message, masked, of the given bytes.
  bool send_message(std::string_view text);
  /// The same of bytes that were compressed (RFC 7692).
  bool send_compressed(std::string_view bytes) { return send_first_byte_and('\xc1', bytes); }
  /// Head of a text message of `length` bytes, of which none follow.
  bool send_message_head(std::uint64_t length);

 private:
  /// Adds what comes to `heard`, until that has `size` bytes. False where it does not come to that.
  bool receive_until(std::string& heard, std::size_t size);
  bool send_first_byte_and(char first, std::string_view payload);
  int fd_ = -1;
};

[[nodiscard]] std::string get(const std::string& target, const std::string& host, const std::string& method = "GET");

}  // namespace curbstone::viewer::web
