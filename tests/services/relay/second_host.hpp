#pragma once

#include <functional>
#include <string>

namespace curbstone::relay {

/// A second network namespace, joined to the one of the test by a cable (a veth pair): 192.168.2.1 here, 192.168.2.2
/// there. Needs root, as scripts/isolated does. The cable is `cable0` at this end.
class SecondHost {
 public:
  SecondHost();
  ~SecondHost();
  SecondHost(const SecondHost&) = delete;
  SecondHost& operator=(const SecondHost&) = delete;

  /// Sockets that `work` opens belong to the second host.
  void run(const std::function<void()>& work) const;
  /// What to put before a command so that it runs there.
  [[nodiscard]] std::string prefix() const { return "nsenter --net=" + network() + " "; }

 private:
  [[nodiscard]] std::string network() const;

  int here_ = -1;
  int there_ = -1;
};

/// Runs it by sh; throws when it fails.
void shell(const std::string& command);

}  // namespace curbstone::relay
