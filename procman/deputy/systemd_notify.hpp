#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "procman/process/file_descriptor.hpp"

namespace curbstone::procman::deputy {

/// Tells systemd the state of the service (sd_notify(3)): "READY=1", "STOPPING=1". No effect where the process was not
/// started by a unit with Type=notify.
void notify_systemd(std::string_view state);

/// A descriptor that systemd keeps while the service is restarted, FileDescriptorStoreMax= of its unit. When the
/// service is stopped, systemd closes it. A name has no colon, and at most 255 characters.
struct KeptDescriptor {
  std::string name;
  process::FileDescriptor fd;
};
void keep_descriptor(const std::string& name, int fd);
void forget_descriptor(const std::string& name);
/// Those that an earlier process of the service left there; at the first call only. They stay there.
[[nodiscard]] std::vector<KeptDescriptor> take_kept_descriptors();

/// Whether systemd listens.
[[nodiscard]] bool is_systemd_service();

}  // namespace curbstone::procman::deputy
