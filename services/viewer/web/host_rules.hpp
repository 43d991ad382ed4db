#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace curbstone::viewer::web {

/// By which names the viewer may be called. A name of an attacker's that resolves to this machine makes a browser send
/// requests here in which Host and Origin agree; only a list of names tells them apart (DNS rebinding).
class HostRules {
 public:
  /// 127.0.0.1, localhost and [::1] are always allowed. The others are compared whole, without regard to case.
  explicit HostRules(std::vector<std::string> names);

  /// `host`: the header, "name" or "name:port"; any port, as `ssh -L` changes it.
  [[nodiscard]] bool allows_host(std::string_view host) const;
  /// Whether a page of this viewer sent the request: `origin` is http:// or https:// and the same `host`.
  [[nodiscard]] bool allows_origin(std::string_view origin, std::string_view host) const;

 private:
  std::vector<std::string> names_;
};

}  // namespace curbstone::viewer::web
