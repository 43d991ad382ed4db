#include "tests/services/relay/second_host.hpp"

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>

namespace curbstone::relay {

namespace {

constexpr const char* kNetwork = "/proc/thread-self/ns/net";

void enter(int network) {
  if (setns(network, CLONE_NEWNET) != 0) throw std::runtime_error("setns");
}

}  // namespace

void shell(const std::string& command) {
  if (std::system(command.c_str()) != 0) throw std::runtime_error(command);
}

SecondHost::SecondHost() : here_(open(kNetwork, O_RDONLY | O_CLOEXEC)) {
  if (unshare(CLONE_NEWNET) != 0) throw std::runtime_error("unshare");
  there_ = open(kNetwork, O_RDONLY | O_CLOEXEC);
  shell("ip link set lo up && ip route add 224.0.0.0/4 dev lo");
  enter(here_);
  shell("ip link add cable0 type veth peer name cable1 netns " + network());
  shell("ip address add 192.168.2.1/24 dev cable0 && ip link set cable0 up");
  run([] { shell("ip address add 192.168.2.2/24 dev cable1 && ip link set cable1 up"); });
  // The cable is ready a moment later, and what is sent until then is lost.
  shell("for i in $(seq 500); do ip link show cable0 | grep -q 'state UP' && exit 0; sleep 0.01; done; exit 1");
}

SecondHost::~SecondHost() {
  std::system("ip link del cable0");
  close(here_);
  close(there_);
}

std::string SecondHost::network() const {
  return "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(there_);
}

void SecondHost::run(const std::function<void()>& work) const {
  enter(there_);
  work();
  enter(here_);
}

}  // namespace curbstone::relay
