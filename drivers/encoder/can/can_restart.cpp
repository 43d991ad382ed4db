#include "drivers/encoder/can/can_restart.hpp"

#include <fmt/format.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

namespace curbstone::encoder::can {

namespace {

/// A request in the kernel's format: attributes within attributes.
class LinkRequest {
 public:
  explicit LinkRequest(int index) {
    header().nlmsg_len = NLMSG_LENGTH(sizeof(ifinfomsg));
    header().nlmsg_type = RTM_NEWLINK;
    header().nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK;
    static_cast<ifinfomsg*>(NLMSG_DATA(&header()))->ifi_index = index;
  }
  std::size_t begin(unsigned short type) {
    const std::size_t at = header().nlmsg_len;
    add(type, {});
    return at;
  }
  void end(std::size_t at) {
    reinterpret_cast<rtattr*>(&bytes_[at])->rta_len = static_cast<unsigned short>(header().nlmsg_len - at);
  }
  void add(unsigned short type, std::string_view data) {
    auto* attribute = reinterpret_cast<rtattr*>(&bytes_[header().nlmsg_len]);
    attribute->rta_type = type;
    attribute->rta_len = static_cast<unsigned short>(RTA_LENGTH(data.size()));
    data.copy(static_cast<char*>(RTA_DATA(attribute)), data.size());
    header().nlmsg_len += static_cast<unsigned>(RTA_SPACE(data.size()));
  }
  [[nodiscard]] const void* data() const { return bytes_.data(); }
  [[nodiscard]] std::size_t size() { return header().nlmsg_len; }

 private:
  nlmsghdr& header() { return *reinterpret_cast<nlmsghdr*>(bytes_.data()); }
  alignas(nlmsghdr) std::array<char, 128> bytes_{};  // the attributes added here take less than 100 bytes
};

/// Returns 0, or the error.
int ask(int fd, LinkRequest& request) {
  if (send(fd, request.data(), request.size(), 0) < 0) return errno;
  alignas(nlmsghdr) std::array<char, 1024> answer{};
  const ssize_t size = recv(fd, answer.data(), answer.size(), 0);
  if (size < 0) return errno;
  const auto* header = reinterpret_cast<const nlmsghdr*>(answer.data());
  if (static_cast<std::size_t>(size) < NLMSG_LENGTH(sizeof(nlmsgerr)) || header->nlmsg_type != NLMSG_ERROR)
    return EPROTO;
  return -static_cast<const nlmsgerr*>(NLMSG_DATA(header))->error;
}

}  // namespace

std::string restart_can(const std::string& interface) {
  const unsigned index = if_nametoindex(interface.c_str());
  if (index == 0) return "there is no such interface";
  const int fd = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
  if (fd < 0) return std::strerror(errno);
  const timeval patience{0, 100'000};  // the kernel answers within the call
  setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);

  LinkRequest request(static_cast<int>(index));
  const std::size_t info = request.begin(IFLA_LINKINFO);
  request.add(IFLA_INFO_KIND, "can");
  const std::size_t data = request.begin(IFLA_INFO_DATA);
  const std::uint32_t yes = 1;
  request.add(IFLA_CAN_RESTART, {reinterpret_cast<const char*>(&yes), sizeof yes});
  request.end(data);
  request.end(info);
  const int error = ask(fd, request);
  close(fd);
  switch (error) {
    case 0:
      return {};
    case EPERM:
      return "this needs CAP_NET_ADMIN; or let the kernel do it, by restart-ms";
    case EINVAL:
      return "the kernel restarts it by itself (restart-ms)";
    default:
      return std::strerror(error);
  }
}

}  // namespace curbstone::encoder::can
