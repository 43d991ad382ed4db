#include "common/packing/unnamed_file.hpp"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

namespace curbstone {
namespace {

std::error_code system_error_of(int error) {
  return {error, std::generic_category()};
}

}  // namespace

UnnamedFile::UnnamedFile(const std::string& folder) {
  std::string name = folder + "/.curbstone-spill-XXXXXX";
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) throw std::system_error(system_error_of(errno));
  ::unlink(name.c_str());
}

UnnamedFile::~UnnamedFile() {
  ::close(descriptor_);
}

bool UnnamedFile::has_room_for(std::uint64_t bytes) const {
  struct statvfs disk {};
  return ::fstatvfs(descriptor_, &disk) != 0 || disk.f_bavail * disk.f_frsize >= bytes;
}

std::error_code UnnamedFile::write(std::uint64_t page, std::span<const std::byte> bytes) const {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t put =
        ::pwrite(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(page * kPage + done));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return system_error_of(put < 0 ? errno : ENOSPC);
    done += static_cast<std::size_t>(put);
  }
  return {};
}

std::error_code UnnamedFile::read(std::uint64_t page, std::span<std::byte> bytes) const {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t got =
        ::pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(page * kPage + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return system_error_of(got < 0 ? errno : ENODATA);
    done += static_cast<std::size_t>(got);
  }
  return {};
}

void UnnamedFile::trim(std::uint64_t page) const {
  (void)!::ftruncate(descriptor_, static_cast<off_t>(page * kPage));
}

}  // namespace curbstone
