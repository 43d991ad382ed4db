#include "tools/simulate/rig/packet_spool.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tools/simulate/sensors/lidar_model.hpp"

namespace curbstone::simulate::rig {

namespace {

struct Header {
  std::array<char, 8> magic{'C', 'U', 'R', 'B', 'S', 'P', 'L', '1'};
  std::uint64_t fingerprint = 0;
  std::int64_t packets = 0;
  bool operator==(const Header&) const = default;
};
constexpr std::int64_t kBatch = 64;  // packets per write

bool write_all(int fd, const void* data, std::size_t size, std::size_t offset) {
  return pwrite(fd, data, size, static_cast<off_t>(offset)) == static_cast<ssize_t>(size);
}

int open_file(const std::string& file) {
  if (!file.empty()) return open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  std::string name = std::filesystem::temp_directory_path() / "curbstone-spool-XXXXXX";
  const int fd = mkostemp(name.data(), O_CLOEXEC);
  if (fd >= 0) unlink(name.c_str());  // removed with the process, however it ends
  return fd;
}

}  // namespace

PacketSpool::PacketSpool(const Drive& drive, const std::string& file, std::uint64_t fingerprint, int threads,
                         const std::atomic<bool>& cancel)
    : file_(file.empty() ? "the temporary spool of packets" : file),
      device_(devices::make_lidar(drive.lidar, drive.rpm)),
      fd_(open_file(file)),
      packets_(static_cast<std::int64_t>(std::ceil(drive.seconds / device_->table().packet_period()))) {
  if (fd_ < 0) throw std::runtime_error(fmt::format("{}: cannot be written: {}", file_, std::strerror(errno)));
  try {
    Header wanted;
    wanted.fingerprint = fingerprint;
    wanted.packets = packets_;
    Header found;
    reused_ = pread(fd_, &found, sizeof found, 0) == sizeof found && found == wanted;
    if (!reused_) {
      if (ftruncate(fd_, 0) != 0) throw std::runtime_error(fmt::format("{}: {}", file_, std::strerror(errno)));
      render(drive, threads, cancel);
      if (!write_all(fd_, &wanted, sizeof wanted, 0))
        throw std::runtime_error(fmt::format("{}: is the disk full?", file_));
    }
    const auto bytes = sizeof(Header) + static_cast<std::size_t>(packets_) * device_->table().packet_size;
    struct stat status {};
    if (fstat(fd_, &status) != 0 || static_cast<std::size_t>(status.st_size) < bytes)
      throw std::runtime_error(fmt::format("{}: is cut off: remove it", file_));
    void* map = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, fd_, 0);
    if (map == MAP_FAILED)
      throw std::runtime_error(fmt::format("{}: cannot be mapped: {}", file_, std::strerror(errno)));
    data_ = static_cast<const std::uint8_t*>(map) + sizeof(Header);
    bytes_ = bytes;
  } catch (...) {
    close(fd_);
    throw;
  }
}

PacketSpool::~PacketSpool() {
  munmap(const_cast<std::uint8_t*>(data_) - sizeof(Header), bytes_);
  close(fd_);
}

void PacketSpool::render(const Drive& drive, int threads, const std::atomic<bool>& cancel) const {
  std::atomic<std::int64_t> next{0};
  std::atomic<bool> failed{false};
  const auto work = [&] {
    // The devices run already, and their listeners have priority over rendering. On Linux this is the thread's own
    // priority.
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 10);
    const auto surroundings = drive.make_surroundings();
    sensors::LidarModel lidar({drive.rpm, drive.seed, drive.azimuth, drive.start_utime, drive.lidar},
                              drive.config.vehicle, drive.motion, *surroundings);
    std::vector<std::uint8_t> batch;
    for (std::int64_t first; (first = next.fetch_add(kBatch)) < packets_ && !failed && !cancel;) {
      lidar.skip_to(first);
      batch.clear();
      for (std::int64_t i = first; i < std::min(first + kBatch, packets_); ++i) {
        const std::vector<std::uint8_t> bytes = lidar.next().bytes;
        batch.insert(batch.end(), bytes.begin(), bytes.end());
      }
      const auto offset = sizeof(Header) + static_cast<std::size_t>(first) * device_->table().packet_size;
      if (!write_all(fd_, batch.data(), batch.size(), offset)) failed = true;
    }
  };
  std::vector<std::thread> workers;
  for (int i = 1; i < threads; ++i) workers.emplace_back(work);
  work();
  for (auto& worker : workers) worker.join();
  if (cancel) throw std::runtime_error("interrupted");
  if (failed) throw std::runtime_error(fmt::format("{}: cannot be written: is the disk full?", file_));
}

std::vector<std::uint8_t> PacketSpool::packet(std::int64_t index, std::int64_t utime) const {
  const std::size_t size = device_->table().packet_size;
  const std::uint8_t* begin = data_ + static_cast<std::size_t>(index) * size;
  std::vector<std::uint8_t> packet(begin, begin + size);
  device_->set_time(packet, utime);
  return packet;
}

}  // namespace curbstone::simulate::rig
