#include "common/packing/spill_file.hpp"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include "common/packing/free_pages.hpp"

namespace curbstone {
namespace {

constexpr std::uint64_t kPage = 4096;
constexpr std::chrono::seconds kPatience{5};  // retry after a disk error
constexpr std::size_t kMuch = 8'000'000;      // bytes
constexpr std::uint64_t kWorthwhile = 256;    // pages: fewer free pages at the end are not returned to the disk

std::uint32_t checksum_of(const PackedValues& bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string in_words(int error) {
  return std::generic_category().message(error);
}

}  // namespace

/// The storage of the values: `bytes` until they are written to the file.
struct SpillFile::Values::Place {
  Place(PackedValues values, std::shared_ptr<File> of);
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;
  ~Place();
  [[nodiscard]] std::uint64_t num_pages() const { return (size + kPage - 1) / kPage; }

  PackedValues bytes;
  std::size_t size;
  std::uint64_t turn = 0;             // key in the queue of writes
  std::optional<std::uint64_t> page;  // the first one in the file
  std::uint32_t checksum = 0;         // of the bytes in the file: the disk is verified, memory is not
  std::shared_ptr<File> file;
};

/// The file and its writer thread. The lock guards its members and the locations of places. The content of the file
/// needs no lock: a place being read or written is held by its reader or writer.
class SpillFile::File {
 public:
  using Place = Values::Place;
  File(const std::string& folder, std::uint64_t leave_free) : folder_(folder), leave_free_(leave_free) { open(folder); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }

  void put(const std::shared_ptr<Place>& place) {
    const std::lock_guard lock(mutex_);
    if (!is_open()) return;
    place->turn = ++turn_;
    waiting_.emplace(place->turn, place);
    news_.notify_all();
  }
  void entered(const Place& place) {
    const std::lock_guard lock(mutex_);
    in_memory_ += place.size;
  }
  void left(const Place& place) {
    const std::lock_guard lock(mutex_);
    (place.page ? in_file_ : in_memory_) -= place.size;
    waiting_.erase(place.turn);
    if (!place.page) return;
    free_.release(*place.page, place.num_pages());
    if (has_free_end()) news_.notify_all();
  }
  [[nodiscard]] PackedValues read(const Place& place) const {
    {
      const std::lock_guard lock(mutex_);
      if (!place.page) return place.bytes;
    }
    PackedValues bytes(place.size);
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t got = ::pread(descriptor_, bytes.data() + done, bytes.size() - done,
                                  static_cast<off_t>(*place.page * kPage + done));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) fail_to_read(got < 0 ? in_words(errno) : "the file is too short");
      done += static_cast<std::size_t>(got);
    }
    if (checksum_of(bytes) != place.checksum) fail_to_read("a checksum is wrong");
    return bytes;
  }

  /// Writes the waiting places until stop().
  void run() {
    std::unique_lock lock(mutex_);
    while (true) {
      if (waiting_.empty()) {
        fault_.clear();  // no values are left in memory because of a fault
        release_the_end(lock);
      }
      news_.wait(lock, [this] { return stopped_ || !waiting_.empty() || has_free_end(); });
      if (stopped_) return;
      if (waiting_.empty()) continue;
      std::shared_ptr<Place> place = waiting_.begin()->second.lock();
      waiting_.erase(waiting_.begin());
      if (place) write(*place, lock);
      if (place && !place->page) waiting_.emplace(place->turn, place);
      lock.unlock();  // the lock is released before `place`, whose destruction locks it
      place.reset();
      lock.lock();
      news_.notify_all();
      if (!fault_.empty()) news_.wait_for(lock, kPatience, [this] { return stopped_; });
    }
  }
  void stop() {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    news_.notify_all();
  }
  void flush() {
    std::unique_lock lock(mutex_);
    news_.wait(lock, [this] { return (waiting_.empty() && !writing_) || !fault_.empty(); });
  }

  [[nodiscard]] bool is_there(const Place& place) const {
    const std::lock_guard lock(mutex_);
    return place.page.has_value();
  }
  [[nodiscard]] bool takes() const {
    const std::lock_guard lock(mutex_);
    return is_open() && fault_.empty();
  }
  [[nodiscard]] std::size_t in_memory() const {
    const std::lock_guard lock(mutex_);
    return in_memory_;
  }
  [[nodiscard]] std::size_t in_file() const {
    const std::lock_guard lock(mutex_);
    return in_file_;
  }
  [[nodiscard]] std::int64_t failed_reads() const { return failed_reads_; }
  [[nodiscard]] std::string read_fault() const {
    const std::lock_guard lock(mutex_);
    return read_fault_;
  }
  [[nodiscard]] std::string fault() const {
    const std::lock_guard lock(mutex_);
    return fault_;
  }

 private:
  [[noreturn]] void fail_to_read(const std::string& why) const {
    ++failed_reads_;
    const std::lock_guard lock(mutex_);
    read_fault_ = folder_ + ": " + why;
    throw std::runtime_error("spilled values: " + read_fault_);
  }
  void open(const std::string& folder) {
    if (folder.empty()) return;
    std::string name = folder + "/.curbstone-spill-XXXXXX";
    descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
    if (descriptor_ < 0) {
      fault_ = folder + ": " + in_words(errno);
    } else {
      ::unlink(name.c_str());
    }
  }
  /// Whether enough pages are free at the end to be worth a system call.
  [[nodiscard]] bool has_free_end() const { return free_.num_pages() + kWorthwhile <= has_pages_; }
  /// Releases the lock while the disk works: only this thread takes pages.
  void release_the_end(std::unique_lock<std::mutex>& lock) {
    if (!has_free_end()) return;
    const std::uint64_t end = free_.num_pages();
    lock.unlock();
    (void)!::ftruncate(descriptor_, static_cast<off_t>(end * kPage));
    lock.lock();
    has_pages_ = end;
  }
  /// Releases the lock while the disk works. Afterwards the place has its page, or there is a fault.
  void write(Place& place, std::unique_lock<std::mutex>& lock) {
    const std::uint64_t page = free_.take(place.num_pages());
    const bool needs_room = page + place.num_pages() > has_pages_;
    writing_ = true;
    lock.unlock();
    std::string fault = write_at(page, place.bytes, needs_room);
    const std::uint32_t checksum = checksum_of(place.bytes);
    lock.lock();
    writing_ = false;
    fault_ = std::move(fault);
    if (!fault_.empty()) return free_.release(page, place.num_pages());
    has_pages_ = std::max(has_pages_, page + place.num_pages());
    place.page = page;
    place.checksum = checksum;
    in_memory_ -= place.size;
    in_file_ += place.size;
    place.bytes = PackedValues();
  }
  /// Returns the error in words; empty if there is none.
  [[nodiscard]] std::string write_at(std::uint64_t page, const PackedValues& bytes, bool needs_room) const {
    struct statvfs disk {};
    if (needs_room && ::fstatvfs(descriptor_, &disk) == 0 && disk.f_bavail * disk.f_frsize < leave_free_ + bytes.size())
      return "the disk is nearly full";
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t put =
          ::pwrite(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(page * kPage + done));
      if (put < 0 && errno == EINTR) continue;
      if (put <= 0) return in_words(put < 0 ? errno : ENOSPC);
      done += static_cast<std::size_t>(put);
    }
    return {};
  }

  std::string folder_;
  std::uint64_t leave_free_;
  int descriptor_ = -1;
  mutable std::mutex mutex_;
  std::condition_variable news_;
  std::map<std::uint64_t, std::weak_ptr<Place>> waiting_;  // by turn
  std::uint64_t turn_ = 0;
  bool writing_ = false;
  bool stopped_ = false;
  FreePages free_;
  std::uint64_t has_pages_ = 0;  // length of the file on the disk; some pages may be free
  std::size_t in_memory_ = 0;    // bytes
  std::size_t in_file_ = 0;      // bytes
  mutable std::atomic<std::int64_t> failed_reads_ = 0;
  std::string fault_;
  mutable std::string read_fault_;
};

SpillFile::Values::Place::Place(PackedValues values, std::shared_ptr<File> of)
    : bytes(std::move(values)), size(bytes.size()), file(std::move(of)) {
  file->entered(*this);
}

SpillFile::Values::Place::~Place() {
  file->left(*this);
}

bool SpillFile::Values::is_in_file() const {
  return place_ && place_->file->is_there(*place_);
}

PackedValues SpillFile::Values::read() const {
  return place_ ? place_->file->read(*place_) : PackedValues();
}

SpillFile::SpillFile(const std::string& folder, std::uint64_t leave_free)
    : file_(std::make_shared<File>(folder, leave_free)) {
  if (file_->is_open()) writer_ = std::thread([file = file_.get()] { file->run(); });
}

SpillFile::~SpillFile() {
  file_->stop();
  if (writer_.joinable()) writer_.join();
}

SpillFile::Values SpillFile::put(PackedValues values) {
  Values result;
  result.place_ = std::make_shared<Values::Place>(std::move(values), file_);
  file_->put(result.place_);
  return result;
}

std::size_t SpillFile::bytes_in_memory() const {
  return file_->in_memory();
}

std::size_t SpillFile::bytes_in_file() const {
  return file_->in_file();
}

std::int64_t SpillFile::failed_reads() const {
  return file_->failed_reads();
}

std::string SpillFile::read_fault() const {
  return file_->read_fault();
}

std::string SpillFile::fault() const {
  return file_->fault();
}

bool SpillFile::takes() const {
  return file_->takes();
}

void SpillFile::flush() {
  file_->flush();
}

void SpillFile::flush_much() {
  if (bytes_in_memory() > kMuch) flush();
}

}  // namespace curbstone
