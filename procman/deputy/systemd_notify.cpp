#include "procman/deputy/systemd_notify.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <sstream>

namespace curbstone::procman::deputy {

namespace {

constexpr int kFirstPassed = 3;  // SD_LISTEN_FDS_START

/// `fd` goes with the message, unless it is -1.
void send(std::string_view state, int fd) {
  const char* path = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  if (path == nullptr || *path == '\0' || std::strlen(path) >= sizeof address.sun_path) return;
  address.sun_family = AF_UNIX;
  std::strcpy(address.sun_path, path);
  if (path[0] == '@') address.sun_path[0] = '\0';             // abstract
  iovec text{const_cast<char*>(state.data()), state.size()};  // msghdr(2) is declared so for receiving, too
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof fd)> control{};
  msghdr message{};
  message.msg_name = &address;
  message.msg_namelen = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(path));
  message.msg_iov = &text;
  message.msg_iovlen = 1;
  if (fd >= 0) {
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    cmsghdr* const header = CMSG_FIRSTHDR(&message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(sizeof fd);
    std::memcpy(CMSG_DATA(header), &fd, sizeof fd);
  }
  const process::FileDescriptor socket(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  (void)::sendmsg(socket.get(), &message, MSG_NOSIGNAL);
}

}  // namespace

void notify_systemd(std::string_view state) {
  send(state, -1);
}

void keep_descriptor(const std::string& name, int fd) {
  send("FDSTORE=1\nFDNAME=" + name, fd);
}

void forget_descriptor(const std::string& name) {
  send("FDSTOREREMOVE=1\nFDNAME=" + name, -1);
}

bool is_systemd_service() {
  return std::getenv("NOTIFY_SOCKET") != nullptr;
}

std::vector<KeptDescriptor> take_kept_descriptors() {
  std::vector<KeptDescriptor> kept;
  const char* const pid = std::getenv("LISTEN_PID");
  const char* const count = std::getenv("LISTEN_FDS");
  const char* const names = std::getenv("LISTEN_FDNAMES");
  if (pid != nullptr && count != nullptr && names != nullptr && std::to_string(getpid()) == pid) {
    std::istringstream list(names);
    const int end = kFirstPassed + std::atoi(count);
    std::string name;
    for (int fd = kFirstPassed; fd < end && std::getline(list, name, ':'); ++fd) {
      if (fcntl(fd, F_SETFD, FD_CLOEXEC) == 0) kept.push_back({name, process::FileDescriptor(fd)});
    }
  }
  for (const char* variable : {"LISTEN_PID", "LISTEN_FDS", "LISTEN_FDNAMES"}) unsetenv(variable);  // not the children's
  return kept;
}

}  // namespace curbstone::procman::deputy
