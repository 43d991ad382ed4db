#include "tests/services/viewer/web/raw_client.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <stdexcept>

namespace curbstone::viewer::web {
namespace {

constexpr int kPatience = 60'000;  // ms, for what takes none on an idle machine

}  // namespace

RawClient::RawClient(std::uint16_t port) : fd_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    throw std::runtime_error("nobody listens");
}

RawClient::~RawClient() {
  if (fd_ >= 0) close(fd_);
}

void RawClient::shrink_receive_buffer() {
  const int size = 4096;
  setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
}

bool RawClient::send_bytes(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

std::string RawClient::receive(int quiet) {
  std::string heard;
  std::array<char, 65536> buffer{};
  pollfd waits{fd_, POLLIN, 0};
  while (poll(&waits, 1, quiet) > 0) {
    const ssize_t n = recv(fd_, buffer.data(), buffer.size(), 0);
    if (n <= 0) break;
    heard.append(buffer.data(), static_cast<std::size_t>(n));
  }
  return heard;
}

bool RawClient::receive_until(std::string& heard, std::size_t size) {
  std::array<char, 65536> buffer{};
  pollfd waits{fd_, POLLIN, 0};
  while (heard.size() < size) {
    if (poll(&waits, 1, kPatience) <= 0) return false;
    const ssize_t n = recv(fd_, buffer.data(), std::min(buffer.size(), size - heard.size()), 0);
    if (n <= 0) return false;
    heard.append(buffer.data(), static_cast<std::size_t>(n));
  }
  return true;
}

std::string RawClient::receive_answer(bool with_body) {
  std::string heard;
  const auto ends = [&] { return heard.ends_with("\r\n\r\n"); };
  while (!ends()) {
    if (!receive_until(heard, heard.size() + 1)) return heard;
  }
  const std::string_view says = "\r\nContent-Length: ";
  const std::size_t length = heard.find(says);
  if (with_body && length != std::string::npos)
    receive_until(heard, heard.size() + std::stoul(heard.substr(length + says.size())));
  return heard;
}

std::string RawClient::receive_frame() {
  std::string heard;
  if (!receive_until(heard, 2)) return heard;
  const auto byte = [&](std::size_t i) { return std::size_t{static_cast<unsigned char>(heard[i])}; };
  std::size_t length = byte(1) & 0x7f;
  const std::size_t head = length == 126 ? 4 : length == 127 ? 10 : 2;
  if (!receive_until(heard, head)) return heard;
  if (head > 2) length = 0;
  for (std::size_t i = 2; i < head; ++i) length = length << 8 | byte(i);
  receive_until(heard, head + length);
  return heard;
}

bool RawClient::is_closed_within(double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  std::array<char, 65536> buffer{};
  while (Clock::now() < end) {
    pollfd waits{fd_, POLLIN, 0};
    if (poll(&waits, 1, 50) > 0 && recv(fd_, buffer.data(), buffer.size(), 0) <= 0) return true;
  }
  return false;
}

std::string RawClient::upgrade(const std::string& host, const std::string& origin, const std::string& target,
                               const std::string& extensions) {
  std::string request = "GET " + target + " HTTP/1.1\r\nHost: " + host +
                        "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
  if (!origin.empty()) request += "Origin: " + origin + "\r\n";
  if (!extensions.empty()) request += "Sec-WebSocket-Extensions: " + extensions + "\r\n";
  send_bytes(request + "\r\n");
  std::string head;
  char c = 0;
  while (head.find("\r\n\r\n") == std::string::npos && recv(fd_, &c, 1, 0) == 1) head += c;
  return head;
}

bool RawClient::send_message(std::string_view text) {
  return send_first_byte_and('\x81', text);
}

bool RawClient::send_first_byte_and(char first, std::string_view text) {
  std::string bytes(1, first);
  if (text.size() < 126) {
    bytes += static_cast<char>(0x80 | text.size());
  } else {
    bytes += static_cast<char>(0x80 | 126);
    bytes += static_cast<char>(text.size() >> 8);
    bytes += static_cast<char>(text.size() & 0xff);
  }
  bytes += std::string(4, '\0');  // a mask that changes nothing
  return send_bytes(bytes + std::string(text));
}

bool RawClient::send_message_head(std::uint64_t length) {
  std::string bytes = "\x81\xff";
  for (int shift = 56; shift >= 0; shift -= 8) bytes += static_cast<char>(length >> shift & 0xff);
  return send_bytes(bytes + std::string(4, '\0'));
}

std::string get(const std::string& target, const std::string& host, const std::string& method) {
  return method + " " + target + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n";
}

}  // namespace curbstone::viewer::web
