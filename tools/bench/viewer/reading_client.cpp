#include "tools/bench/viewer/reading_client.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>

namespace curbstone::bench::viewer {
namespace {

enum Opcode : std::uint8_t { kText = 1, kClose = 8, kPing = 9, kPong = 10 };  // RFC 6455 5.2
constexpr std::uint8_t kLast = 0x80;

void send_all(int fd, const std::string& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t n = ::send(fd, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (n <= 0) throw std::runtime_error("bench viewer: the viewer has closed a page's connection");
    sent += static_cast<std::size_t>(n);
  }
}

}  // namespace

ReadingClient::ReadingClient(std::uint16_t port) {
  fd_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    close(fd_);
    throw std::runtime_error(fmt::format("bench viewer: nothing answers at port {}", port));
  }
  send_all(fd_, fmt::format("GET /live HTTP/1.1\r\nHost: 127.0.0.1:{0}\r\nOrigin: http://127.0.0.1:{0}\r\n"
                            "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                            "Sec-WebSocket-Extensions: permessage-deflate; client_max_window_bits\r\n\r\n",
                            port));
  std::array<char, 4096> part{};
  std::size_t end = std::string::npos;
  while ((end = heard_.find("\r\n\r\n")) == std::string::npos) {
    const ssize_t n = recv(fd_, part.data(), part.size(), 0);
    if (n <= 0) break;
    heard_.append(part.data(), static_cast<std::size_t>(n));
  }
  if (end == std::string::npos || !heard_.starts_with("HTTP/1.1 101")) {
    close(fd_);
    throw std::runtime_error("bench viewer: the viewer refuses a page: " + heard_.substr(0, 60));
  }
  heard_.erase(0, end + 4);
  say(kText, R"({"resume": null})");
  say(kText, R"({"points": true})");
}

ReadingClient::~ReadingClient() {
  close(fd_);
}

void ReadingClient::read() {
  std::array<char, 65536> part{};
  for (ssize_t n = 0; (n = recv(fd_, part.data(), part.size(), MSG_DONTWAIT)) != -1;) {
    if (n == 0) throw std::runtime_error("bench viewer: the viewer has closed a page's connection");
    heard_.append(part.data(), static_cast<std::size_t>(n));
    bytes_ += n;
  }
  if (errno != EAGAIN && errno != EWOULDBLOCK)
    throw std::runtime_error("bench viewer: a page's connection has broken off");
  while (take_part()) {
  }
}

/// A message may come in several parts. False: none is whole yet.
bool ReadingClient::take_part() {
  const auto at = [&](std::size_t i) { return static_cast<std::uint8_t>(heard_[i]); };
  if (heard_.size() < 2) return false;
  std::size_t length = at(1) & 0x7fU, head = 2;
  const std::size_t more = length == 126 ? 2 : length == 127 ? 8 : 0;
  if (heard_.size() < head + more) return false;
  if (more > 0) length = 0;
  for (std::size_t i = 0; i < more; ++i) length = length << 8U | at(head++);
  if (heard_.size() < head + length) return false;
  const std::uint8_t opcode = at(0) & 0x0fU;
  const bool is_last = (at(0) & kLast) != 0;
  const std::string content = heard_.substr(head, length);
  heard_.erase(0, head + length);
  if (opcode == kPing) say(kPong, content);
  // The frames of a connection are numbered from 1 on.
  if (opcode < kClose && is_last) say(kText, fmt::format(R"({{"ack": {}}})", ++frames_));
  return true;
}

/// Masked by zeros: the content as it is.
void ReadingClient::say(std::uint8_t opcode, const std::string& text) {
  std::string bytes{static_cast<char>(kLast | opcode), static_cast<char>(0x80U | text.size()), 0, 0, 0, 0};
  send_all(fd_, bytes + text);  // of less than 126 bytes
}

}  // namespace curbstone::bench::viewer
