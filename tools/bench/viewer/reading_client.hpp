#pragma once

#include <cstdint>
#include <string>

namespace curbstone::bench::viewer {

/// A page without a browser: it opens the viewer's WebSocket as one, with compression, and acknowledges each frame at
/// once, undecoded. One thread. Throws std::runtime_error if the viewer refuses it or goes away.
class ReadingClient {
 public:
  /// `port`: on 127.0.0.1. It shows the LiDAR's points, as a page does at first.
  explicit ReadingClient(std::uint16_t port);
  ~ReadingClient();
  ReadingClient(const ReadingClient&) = delete;
  ReadingClient& operator=(const ReadingClient&) = delete;

  /// Takes what has come; does not wait.
  void read();
  [[nodiscard]] std::int64_t frames() const { return frames_; }
  [[nodiscard]] std::int64_t bytes() const { return bytes_; }  ///< as they came

 private:
  void say(std::uint8_t opcode, const std::string& text);
  bool take_part();

  int fd_ = -1;
  std::string heard_;  // what is not a whole part yet
  std::int64_t frames_ = 0;
  std::int64_t bytes_ = 0;
};

}  // namespace curbstone::bench::viewer
