#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace curbstone::viewer::web {

/// The host names under which the viewer may be reached. If an attacker's host name resolves to this machine, a browser
/// sends requests here whose Host and Origin agree; only a list of allowed names detects that (DNS rebinding).
class HostRules {
 public:
  /// 127.0.0.1, localhost and [::1] are always allowed. Names are compared in full, ignoring case.
  explicit HostRules(std::vector<std::string> names);

  /// `host`: the Host header, "name" or "name:port". Any port is allowed, because `ssh -L` changes it.
  [[nodiscard]] bool allows_host(std::string_view host) const;
  /// Whether a page of this viewer sent the request: `origin` is http:// or https:// followed by the same `host`.
  [[nodiscard]] bool allows_origin(std::string_view origin, std::string_view host) const;

 private:
  std::vector<std::string> names_;
};

}  // namespace curbstone::viewer::web
