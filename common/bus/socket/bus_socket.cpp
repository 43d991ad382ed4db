#include "common/bus/socket/bus_socket.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include "common/bus/socket/channel_filter.hpp"
#include "common/bytes/big_endian.hpp"
#include "common/time/clock.hpp"

namespace curbstone {

namespace {

constexpr std::size_t kHeader = 8;          // "LC02", sequence number
constexpr std::size_t kDatagrams = 32;      // received in one system call
constexpr std::size_t kDatagram = 65'536;   // bytes
constexpr std::uint32_t kTells = 1U << 20;  // bytes: a buffer that cannot fill and empty between two looks at it

/// Datagrams dropped at full receive buffers on this host (in this network namespace): RcvbufErrors in the two UDP
/// lines of /proc/net/snmp, a heading and its values.
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

void set_option(int fd, int level, int option, const void* value, std::size_t size, const char* name) {
  if (setsockopt(fd, level, option, value, static_cast<socklen_t>(size)) != 0)
    throw std::system_error(errno, std::generic_category(), name);
}

void set_option(int fd, int level, int option, int value, const char* name) {
  set_option(fd, level, option, &value, sizeof value, name);
}

sockaddr_in group_of(const BusAddress& address) {
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(static_cast<std::uint16_t>(address.port));
  inet_pton(AF_INET, address.group.c_str(), &group.sin_addr);
  return group;
}

void attach_filter(int fd, const std::vector<sock_filter>& program) {
  const sock_fprog filter{static_cast<unsigned short>(program.size()), const_cast<sock_filter*>(program.data())};
  set_option(fd, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter, "SO_ATTACH_FILTER");
}

/// On the interface of the route to the group.
bool join(int fd, const sockaddr_in& group) {
  const ip_mreqn membership{group.sin_addr, {htonl(INADDR_ANY)}, 0};
  return setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) == 0;
}

/// A socket that receives only datagrams sent to the group.
int open_socket(const BusAddress& address, const std::vector<sock_filter>& filter) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) throw std::system_error(errno, std::generic_category(), "socket");
  try {
    attach_filter(fd, filter);
    const sockaddr_in group = group_of(address);
    set_option(fd, SOL_SOCKET, SO_REUSEADDR, 1, "SO_REUSEADDR");
    set_option(fd, SOL_SOCKET, SO_TIMESTAMP, 1, "SO_TIMESTAMP");
    if (address.buffer > 0) set_option(fd, SOL_SOCKET, SO_RCVBUF, address.buffer, "SO_RCVBUF");
    if (bind(fd, reinterpret_cast<const sockaddr*>(&group), sizeof group) != 0)
      throw std::system_error(errno, std::generic_category(), "bind");
    if (!join(fd, group)) throw std::system_error(errno, std::generic_category(), "IP_ADD_MEMBERSHIP");
  } catch (...) {
    close(fd);
    throw;
  }
  return fd;
}

/// The time at which the kernel received the datagram, us.
std::int64_t time_of(const msghdr& header) {
  for (const cmsghdr* control = CMSG_FIRSTHDR(&header); control != nullptr;
       control = CMSG_NXTHDR(const_cast<msghdr*>(&header), const_cast<cmsghdr*>(control))) {
    if (control->cmsg_level != SOL_SOCKET || control->cmsg_type != SCM_TIMESTAMP) continue;
    timeval time{};
    std::memcpy(&time, CMSG_DATA(control), sizeof time);
    return std::int64_t{time.tv_sec} * 1'000'000 + time.tv_usec;
  }
  return wall_clock();
}

bool is_fragment(std::span<const std::uint8_t> datagram) {
  return datagram.size() >= 4 && read_big_endian<std::uint32_t>(datagram) == FragmentAssembler::kMagic;
}

/// Address and port as one number.
std::uint64_t number_of(const sockaddr_in& sender) {
  return std::uint64_t{ntohl(sender.sin_addr.s_addr)} << 16 | ntohs(sender.sin_port);
}

}  // namespace

/// The buffers of recvmmsg().
struct BusSocket::Batch {
  std::unique_ptr<std::uint8_t[]> bytes = std::make_unique_for_overwrite<std::uint8_t[]>(kDatagrams * kDatagram);
  std::array<std::array<std::uint8_t, CMSG_SPACE(sizeof(timeval))>, kDatagrams> controls{};
  std::array<iovec, kDatagrams> parts{};
  std::array<sockaddr_in, kDatagrams> senders{};
  std::array<mmsghdr, kDatagrams> headers{};

  /// Sets the buffers for the next datagrams: the kernel overwrites the sizes.
  void prepare() {
    for (std::size_t i = 0; i < kDatagrams; ++i) {
      parts[i] = {datagram(i), kDatagram};
      headers[i] = {};
      headers[i].msg_hdr.msg_name = &senders[i];
      headers[i].msg_hdr.msg_namelen = sizeof senders[i];
      headers[i].msg_hdr.msg_iov = &parts[i];
      headers[i].msg_hdr.msg_iovlen = 1;
      headers[i].msg_hdr.msg_control = controls[i].data();
      headers[i].msg_hdr.msg_controllen = controls[i].size();
    }
  }
  [[nodiscard]] std::uint8_t* datagram(std::size_t i) const { return bytes.get() + i * kDatagram; }
};

BusSocket::BusSocket(const BusAddress& address, const std::vector<std::string>& large_channels)
    : address_(address), batch_(std::make_unique<Batch>()), filter_(make_channel_filter({})) {
  if (!large_channels.empty()) assembler_.emplace(large_channels);
  fd_ = open_socket(address_, filter_);
  host_drops_ = dropped_on_host();
  tells_ = look_at_buffer().size >= kTells;
}

BusSocket::~BusSocket() {
  close(fd_);
}

void BusSocket::attach(std::vector<sock_filter> program) {
  const std::scoped_lock lock(filter_mutex_);
  attach_filter(fd_, program);
  filter_ = std::move(program);
}

/// A socket keeps the memberships of interfaces that are gone, and may have 20 of them: another one takes its place.
void BusSocket::follow_route() {
  if (!join(fd_, group_of(address_))) return;  // it is a member there, or there is no route
  const std::scoped_lock lock(filter_mutex_, mutex_);
  const std::uint32_t drops = look_at_buffer().kernel_drops;
  try {
    const int fresh = open_socket(address_, filter_);
    dup3(fresh, fd_, O_CLOEXEC);
    close(fresh);
    kernel_drops_before_ -= drops;  // the other one counts from 0
  } catch (const std::system_error&) {
    // The route is gone again; the socket is a member where it was.
  }
}

void BusSocket::pass_only(const std::vector<std::string>& channels) {
  try {
    attach(make_channel_filter(channels));
  } catch (const std::system_error&) {
    attach(make_message_filter());  // too many channels for the kernel
  }
}

void BusSocket::pass_all() {
  attach(make_message_filter(assembler_.has_value()));
  note_drops(true);
  const std::scoped_lock lock(mutex_);
  passes_all_ = true;
  kernel_drops_before_ = look_at_buffer().kernel_drops;
  dropped_before_ = dropped_;
}

bool BusSocket::receive(const Handler& handler) {
  note_drops(false);
  batch_->prepare();
  const int count = recvmmsg(fd_, batch_->headers.data(), kDatagrams, MSG_DONTWAIT, nullptr);
  note_drops(false);
  for (std::size_t i = 0; count > 0 && i < static_cast<std::size_t>(count); ++i) {
    const std::span<const std::uint8_t> all(batch_->datagram(i), batch_->headers[i].msg_len);
    const std::int64_t utime = time_of(batch_->headers[i].msg_hdr);
    if (is_fragment(all)) {
      take_fragment(number_of(batch_->senders[i]), all, utime, handler);
      continue;
    }
    const auto name = all.subspan(std::min(kHeader, all.size()));
    const auto end = std::find(name.begin(), name.end(), 0);
    if (end == name.end()) continue;  // the filter passes no such datagram
    const auto size = static_cast<std::size_t>(end - name.begin());
    handler({{reinterpret_cast<const char*>(name.data()), size},
             name.subspan(size + 1),
             utime,
             ntohs(batch_->senders[i].sin_port)});
  }
  return count == static_cast<int>(kDatagrams);
}

void BusSocket::take_fragment(std::uint64_t sender, std::span<const std::uint8_t> datagram, std::int64_t utime,
                              const Handler& handler) {
  if (!assembler_) return;
  const auto whole = assembler_->add(sender, datagram, steady_clock());
  refused_fragments_ = assembler_->refused();
  dropped_large_ = assembler_->dropped();
  if (whole) handler({whole->channel, whole->bytes, utime, static_cast<std::uint16_t>(sender & 0xFFFF)});
}

BusSocket::Buffer BusSocket::look_at_buffer() const {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  if (getsockopt(fd_, SOL_SOCKET, SO_MEMINFO, memory.data(), &size) != 0) return {};
  return {memory[SK_MEMINFO_RCVBUF], memory[SK_MEMINFO_RMEM_ALLOC], memory[SK_MEMINFO_DROPS]};
}

/// Attributes the host's drops since the last look to this socket if its buffer was more than half full then or is now.
void BusSocket::note_drops(bool is_host_wanted) {
  const std::scoped_lock lock(mutex_);
  const Buffer buffer = look_at_buffer();
  const bool fills = !tells_ || buffer.used > buffer.size / 2;
  if (!is_host_wanted && (!tells_ || (!fills && !filled_))) return;
  const std::int64_t host = dropped_on_host();
  if (fills || filled_) dropped_ += host - host_drops_;
  host_drops_ = host;
  filled_ = fills;
}

std::int64_t BusSocket::dropped() {
  note_drops(true);
  const std::scoped_lock lock(mutex_);
  return dropped_;
}

std::int64_t BusSocket::refused() {
  note_drops(true);
  const std::scoped_lock lock(mutex_);
  if (!passes_all_) return 0;
  const std::int64_t all = look_at_buffer().kernel_drops - kernel_drops_before_;  // modulo 2^32, as the kernel counts
  return std::max<std::int64_t>(all - (dropped_ - dropped_before_), 0);
}

}  // namespace curbstone
