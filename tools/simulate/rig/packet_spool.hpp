#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tools/simulate/rig/drive.hpp"

namespace curbstone::simulate::rig {

/// A drive's LiDAR packets, rendered ahead into a file, so that sending them in real time costs little. Their times are
/// relative: the packets' stamps start at the drive's start_utime, and are replaced when they are sent.
class PacketSpool {
 public:
  /// Renders into `file`, or reuses it if it was rendered from the same `fingerprint`. An empty name means a temporary
  /// file. Throws std::runtime_error (disk full, cancelled).
  PacketSpool(const Drive& drive, const std::string& file, std::uint64_t fingerprint, int threads,
              const std::atomic<bool>& cancel);
  ~PacketSpool();
  PacketSpool(const PacketSpool&) = delete;
  PacketSpool& operator=(const PacketSpool&) = delete;

  [[nodiscard]] std::int64_t size() const { return packets_; }
  /// The packet with its stamp set to `utime`.
  [[nodiscard]] std::vector<std::uint8_t> packet(std::int64_t index, std::int64_t utime) const;
  [[nodiscard]] bool reused() const { return reused_; }

 private:
  void render(const Drive& drive, int threads, const std::atomic<bool>& cancel) const;

  std::string file_;
  std::unique_ptr<devices::LidarEmulator> device_;
  int fd_ = -1;
  std::int64_t packets_ = 0;
  const std::uint8_t* data_ = nullptr;
  std::size_t bytes_ = 0;
  bool reused_ = false;
};

}  // namespace curbstone::simulate::rig
