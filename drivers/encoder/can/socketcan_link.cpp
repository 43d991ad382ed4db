#include "drivers/encoder/can/socketcan_link.hpp"

#include <fmt/format.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "common/time/clock.hpp"

namespace curbstone::encoder::can {

namespace {

constexpr int kMaxReads = 256;  // at a time

constexpr std::int64_t kFirstRestart = RetryBackoff::kFirst;  // us, after a bus-off
constexpr std::int64_t kLastRestart = 2'000'000;

std::string cannot_open(const std::string& interface, const std::string& why) {
  return fmt::format("cannot open CAN interface {}: {}", interface, why);
}

bool is_up(int fd, const std::string& interface) {
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  return ioctl(fd, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

std::string bring_up(const std::string& interface) {
  return fmt::format("`ip link set {} up type can bitrate 500000 restart-ms 100`", interface);
}

CanFrame from_kernel(const can_frame& raw) {
  CanFrame frame;
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
  frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size = raw.can_dlc;
  std::copy_n(raw.data, raw.can_dlc, frame.data.begin());
  return frame;
}

can_frame to_kernel(const CanFrame& frame) {
  can_frame raw{};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0) | (frame.remote ? CAN_RTR_FLAG : 0);
  raw.can_dlc = frame.size;
  std::copy(frame.data.begin(), frame.data.end(), raw.data);
  return raw;
}

/// Time at which the kernel got the frame from its driver; 0 if there is none.
std::int64_t kernel_stamp(msghdr& message) {
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMP) continue;
    timeval time{};
    std::memcpy(&time, CMSG_DATA(c), sizeof time);
    return std::int64_t{time.tv_sec} * 1'000'000 + time.tv_usec;
  }
  return 0;
}

}  // namespace

CanSocket::CanSocket(const std::string& interface, const std::vector<std::uint32_t>& ids) {
  fd_ = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (fd_ < 0) {
    const int error = errno;
    if (error == EAFNOSUPPORT || error == EPROTONOSUPPORT || error == ESOCKTNOSUPPORT) {
      throw NoSocketCan(cannot_open(
          interface, "this kernel has no CAN: use slcan (interface: slcan, device: the serial port of an adapter)"));
    }
    throw std::runtime_error(cannot_open(interface, std::strerror(error)));
  }
  std::string why;
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  std::vector<can_filter> filters;
  for (const std::uint32_t id : ids)
    filters.push_back({id, ((id & CAN_EFF_FLAG) != 0 ? CAN_EFF_MASK : CAN_SFF_MASK) | CAN_EFF_FLAG});
  const can_err_mask_t errors = CAN_ERR_MASK;
  const int on = 1;
  if (address.can_ifindex == 0) {
    why = "there is no such interface; `ip link` shows what there is";
  } else if (!is_up(fd_, interface)) {
    why = "it is down; " + bring_up(interface);
  } else if (setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                        static_cast<socklen_t>(filters.size() * sizeof(can_filter))) != 0 ||
             setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) != 0 ||
             setsockopt(fd_, SOL_SOCKET, SO_TIMESTAMP, &on, sizeof on) != 0 ||
             bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    why = std::strerror(errno);
  }
  if (why.empty()) return;
  close();
  throw std::runtime_error(cannot_open(interface, why));
}

CanSocket::~CanSocket() {
  close();
}

CanSocket::CanSocket(CanSocket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

CanSocket& CanSocket::operator=(CanSocket&& other) noexcept {
  if (this != &other) {
    close();
    fd_ = std::exchange(other.fd_, -1);
  }
  return *this;
}

void CanSocket::close() noexcept {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

CanSocket::Read CanSocket::read() {
  can_frame raw{};
  iovec data{&raw, sizeof raw};
  alignas(cmsghdr) char control[128];
  msghdr message{};
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  Read read;
  const ssize_t size = ::recvmsg(fd_, &message, 0);
  if (size < 0) {
    read.status = errno == EAGAIN || errno == EINTR ? Status::kNothing : Status::kDown;
    return read;
  }
  read.utime = kernel_stamp(message);
  if (size != static_cast<ssize_t>(sizeof raw) || raw.can_dlc > CAN_MAX_DLEN) {
    read.status = Status::kRefused;
  } else if ((raw.can_id & CAN_ERR_FLAG) != 0) {
    read.status = Status::kErrorFrame;
    read.error_bits = raw.can_id & CAN_ERR_MASK;
  } else {
    read.status = Status::kFrame;
    read.frame = from_kernel(raw);
  }
  return read;
}

bool CanSocket::write(const CanFrame& frame) {
  const can_frame raw = to_kernel(frame);
  return ::write(fd_, &raw, sizeof raw) == static_cast<ssize_t>(sizeof raw);
}

SocketCanLink::SocketCanLink(std::string interface, std::vector<std::uint32_t> ids, Restart restart)
    : interface_(std::move(interface)), ids_(std::move(ids)), restart_(std::move(restart)) {
  if (interface_.empty() || interface_.size() >= IFNAMSIZ || interface_.find('/') != std::string::npos)
    throw NoSocketCan(cannot_open(interface_, "an interface is named like can0"));
  try {
    socket_.emplace(interface_, ids_);
  } catch (const NoSocketCan&) {
    throw;
  } catch (const std::runtime_error& error) {
    why_ = error.what();
    retry_.failed(steady_clock());
  }
}

void SocketCanLink::attach(EventLoop& loop, Handlers handlers) {
  loop_ = &loop;
  handlers_ = std::move(handlers);
  if (socket_) {
    watch();
  } else {
    handlers_.on_link(wall_clock(), link::LinkState::kDown, why_);
  }
  loop.every(std::chrono::milliseconds(100), [this] {
    try_to_open();
    try_to_restart();
  });
}

void SocketCanLink::watch() {
  loop_->watch(socket_->fd(), [this] { on_readable(); });
}

void SocketCanLink::on_readable() {
  for (int i = 0; i < kMaxReads && socket_; ++i) {
    const CanSocket::Read read = socket_->read();
    switch (read.status) {
      case CanSocket::Status::kNothing:
        return;
      case CanSocket::Status::kDown:
        return lose();
      case CanSocket::Status::kRefused:
        counters_.add("refused.can_frame");
        handlers_.on_refused(wall_clock(), "refused.can_frame");
        break;
      case CanSocket::Status::kErrorFrame:
        on_error_frame(read.error_bits);
        break;
      case CanSocket::Status::kFrame:
        counters_.add("can.frames");
        bus_off_ = false;
        restart_after_ = 0;
        restart_failed_.clear();
        handlers_.on_frame(read.utime != 0 ? read.utime : wall_clock(), read.frame);
        break;
    }
  }
}

void SocketCanLink::on_error_frame(std::uint32_t bits) {
  counters_.add("can.errors");
  if ((bits & CAN_ERR_BUSOFF) != 0) {
    counters_.add("can.bus_off");
    if (!bus_off_) {
      restart_after_ = restart_after_ == 0 ? kFirstRestart : std::min(2 * restart_after_, kLastRestart);
      restart_at_ = steady_clock() + restart_after_;
    }
    bus_off_ = true;
  }
  if ((bits & CAN_ERR_RESTARTED) != 0) bus_off_ = false;
}

void SocketCanLink::lose() {
  loop_->unwatch(socket_->fd());
  socket_.reset();
  bus_off_ = false;
  retry_.lost(steady_clock());
  handlers_.on_link(wall_clock(), link::LinkState::kDown,
                    fmt::format("CAN interface {} went down; waiting for it to come back", interface_));
}

void SocketCanLink::try_to_open() {
  if (socket_ || !retry_.due(steady_clock())) return;
  try {
    socket_.emplace(interface_, ids_);
  } catch (const std::runtime_error& error) {
    retry_.failed(steady_clock());
    handlers_.on_link(wall_clock(), link::LinkState::kDown, error.what());
    return;
  }
  watch();
  handlers_.on_link(wall_clock(), link::LinkState::kUp, "");
}

void SocketCanLink::try_to_restart() {
  if (!socket_ || !bus_off_ || steady_clock() < restart_at_) return;
  restart_failed_ = restart_(interface_);
  counters_.add(restart_failed_.empty() ? "can.restarts" : "can.restart_failed");
  restart_after_ = std::min(2 * restart_after_, kLastRestart);
  restart_at_ = steady_clock() + restart_after_;
}

void SocketCanLink::send(const CanFrame& frame) {
  if (!socket_ || !socket_->write(frame)) counters_.add("can.send_failed");
}

void SocketCanLink::report(NodeReport& report) const {
  report.counters.add(counters_);
  if (!bus_off_) return;
  report.faults.push_back(fmt::format("CAN interface {} is bus-off: cable, terminator or bit rate{}", interface_,
                                      restart_failed_.empty() ? "" : "; it cannot be restarted: " + restart_failed_));
}

}  // namespace curbstone::encoder::can
