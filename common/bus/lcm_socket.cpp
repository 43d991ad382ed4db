#include "common/bus/lcm_socket.hpp"

#include <linux/sock_diag.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "common/bus/channel_filter.hpp"

namespace curbstone {
namespace {

/// Datagrams dropped at full receive buffers on this host (in this network namespace): RcvbufErrors, of
/// /proc/net/snmp's two lines on UDP, a heading and its values.
std::int64_t dropped_on_host() {
  std::ifstream table("/proc/self/net/snmp");
  std::string heading, values;
  for (std::string line; values.empty() && std::getline(table, line);) {
    if (line.starts_with("Udp:")) (heading.empty() ? heading : values) = line;
  }
  std::istringstream names(heading), numbers(values);
  for (std::string name, number; names >> name && numbers >> number;) {
    if (name == "RcvbufErrors") return std::stoll(number);
  }
  return 0;
}

}  // namespace

std::vector<int> LcmSocket::open_sockets() {
  std::vector<int> sockets;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", ignored)) {
    const std::string name = entry.path().filename().string();
    int fd = -1;
    std::from_chars(name.data(), name.data() + name.size(), fd);
    if (std::filesystem::read_symlink(entry.path(), ignored).string().starts_with("socket:")) sockets.push_back(fd);
  }
  return sockets;
}

void LcmSocket::find_since(const std::vector<int>& before) {
  for (const int fd : open_sockets()) {
    if (std::find(before.begin(), before.end(), fd) == before.end()) fd_ = fd;
  }
  host_before_ = dropped_on_host();
}

bool LcmSocket::attach(std::vector<sock_filter> program) const {
  const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
  return setsockopt(fd_, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter) == 0;
}

void LcmSocket::pass_only(const std::vector<std::string>& channels) {
  if (attach(make_channel_filter(channels)))
    turned_away_ = true;
  else
    pass_all();  // too many channels for the kernel; an earlier filter would keep the newest out
}

void LcmSocket::pass_all() {
  if (!attach(make_message_filter())) throw std::runtime_error("cannot filter the bus: SO_ATTACH_FILTER is refused");
}

std::int64_t LcmSocket::dropped() const {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  if (getsockopt(fd_, SOL_SOCKET, SO_MEMINFO, memory.data(), &size) != 0) return 0;
  const std::int64_t own = memory[SK_MEMINFO_DROPS];
  return turned_away_ ? std::min(own, dropped_on_host() - host_before_) : own;
}

}  // namespace curbstone
