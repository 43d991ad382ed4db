#include "tools/bench/programs/service_manager.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

namespace curbstone::bench::programs {

namespace {
constexpr int kLook = 20;  // ms
}

ServiceManager::ServiceManager() : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  socklen_t size = sizeof address;
  // Bound to the family alone it gets an abstract address of its own, unix(7).
  if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address.sun_family) != 0 ||
      getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    const int error = errno;
    close(socket_);
    throw std::system_error(error, std::generic_category(), "socket for notifications");
  }
  address_.assign(address.sun_path, size - offsetof(sockaddr_un, sun_path));
  address_.at(0) = '@';
  receiver_ = std::thread([this] {
    while (!ends_) {
      pollfd readable{socket_, POLLIN, 0};
      if (poll(&readable, 1, kLook) > 0) receive();
    }
  });
}

ServiceManager::~ServiceManager() {
  ends_ = true;
  receiver_.join();
  close_all();
  close(socket_);
}

void ServiceManager::receive() {
  std::array<char, 4096> text{};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
  iovec part{text.data(), text.size() - 1};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  if (recvmsg(socket_, &message, MSG_CMSG_CLOEXEC) <= 0) return;
  int fd = -1;
  if (const cmsghdr* header = CMSG_FIRSTHDR(&message)) std::memcpy(&fd, CMSG_DATA(header), sizeof fd);
  std::string name;
  bool removes = false;
  std::istringstream lines(text.data());
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("FDNAME=")) name = line.substr(7);
    removes |= line == "FDSTOREREMOVE=1";
  }
  const std::lock_guard lock(mutex_);
  const auto known = kept_.find(name);
  if (removes && known != kept_.end()) {
    close(known->second);
    kept_.erase(known);
  }
  if (fd >= 0 && !kept_.try_emplace(name, fd).second) close(fd);
}

std::unique_ptr<BackgroundProgram> ServiceManager::start(const std::string& line, const std::string& output_file) {
  const std::lock_guard lock(mutex_);
  std::string names;
  std::vector<int> fds;
  for (const auto& [name, fd] : kept_) {
    names += (names.empty() ? "" : ":") + name;
    fds.push_back(fd);
  }
  // The variables are of the shell, which the program replaces: its pid is the program's.
  std::string variables = "env NOTIFY_SOCKET=" + address_ + " ";
  if (!fds.empty())
    variables += "LISTEN_PID=$$ LISTEN_FDS=" + std::to_string(fds.size()) + " LISTEN_FDNAMES=" + names + " ";
  return std::make_unique<BackgroundProgram>(variables + line, output_file, fds);
}

void ServiceManager::close_all() {
  const std::lock_guard lock(mutex_);
  for (const auto& [name, fd] : kept_) close(fd);
  kept_.clear();
}

std::size_t ServiceManager::kept() const {
  const std::lock_guard lock(mutex_);
  return kept_.size();
}

}  // namespace curbstone::bench::programs
