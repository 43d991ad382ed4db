#include "common/packing/spill_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include "common/packing/unnamed_file.hpp"

namespace curbstone {
namespace {

constexpr std::size_t kMuch = 8'000'000;    // bytes
constexpr std::uint64_t kWorthwhile = 256;  // pages: fewer free pages at the end are not returned to the disk

std::uint32_t checksum_of(const PackedValues& bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

bool is_for_lack_of_space(const std::error_code& error) {
  return error == std::errc::no_space_on_device || error == std::errc::file_too_large || error.value() == EDQUOT;
}

}  // namespace

/// The storage of the values: `bytes` until they are written to a file.
struct SpillFile::Values::Place {
  Place(PackedValues values, std::shared_ptr<File> of);
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;
  ~Place();
  [[nodiscard]] std::uint64_t num_pages() const { return (size + UnnamedFile::kPage - 1) / UnnamedFile::kPage; }

  PackedValues bytes;
  std::size_t size;
  std::uint64_t turn = 0;             // key in the queue of writes
  std::shared_ptr<UnnamedFile> disk;  // the file that has them; nullptr: none
  std::uint64_t page = 0;             // the first one there
  std::uint32_t checksum = 0;         // of the bytes in the file: the disk is verified, memory is not
  std::shared_ptr<File> file;
};

/// The file and its writer thread. A file whose disk fails is replaced by another one as soon as the folder takes one;
/// the values in it keep it open. The lock guards the members, the files' pages and the locations of places. The
/// content of a file needs no lock: a place being read or written is held by its reader or writer.
class SpillFile::File {
 public:
  using Place = Values::Place;
  File(std::string folder, std::uint64_t leave_free, std::chrono::milliseconds retry)
      : folder_(std::move(folder)), leave_free_(leave_free), retry_(retry) {
    std::unique_lock lock(mutex_);
    if (has_folder()) open(lock);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  [[nodiscard]] bool has_folder() const { return !folder_.empty(); }

  void put(const std::shared_ptr<Place>& place) {
    const std::lock_guard lock(mutex_);
    if (!has_folder()) return;
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
    (place.disk ? in_file_ : in_memory_) -= place.size;
    waiting_.erase(place.turn);
    unreadable_.erase(&place);
    if (!place.disk) return;
    place.disk->pages.release(place.page, place.num_pages());
    if (has_free_end()) news_.notify_all();
  }
  [[nodiscard]] PackedValues read(const Place& place) const {
    {
      const std::lock_guard lock(mutex_);
      if (!place.disk) return place.bytes;
    }
    PackedValues bytes(place.size);
    if (const std::error_code error = place.disk->read(place.page, bytes))
      fail_to_read(place, error.value() == ENODATA ? "the file is too short" : error.message());
    if (checksum_of(bytes) != place.checksum) fail_to_read(place, "a checksum is wrong");
    const std::lock_guard lock(mutex_);
    unreadable_.erase(&place);
    return bytes;
  }

  /// Writes the waiting places until stop().
  void run() {
    std::unique_lock lock(mutex_);
    while (!stopped_) {
      if (!disk_) open(lock);
      if (disk_ && waiting_.empty()) {
        fault_.clear();  // no values are left in memory because of a fault
        release_the_end(lock);
      }
      if (disk_) {
        news_.wait(lock, [this] { return stopped_ || !waiting_.empty() || has_free_end(); });
        if (stopped_) return;
        write_next(lock);
      }
      news_.notify_all();
      if (!fault_.empty()) news_.wait_for(lock, retry_, [this] { return stopped_; });
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
    return place.disk != nullptr;
  }
  [[nodiscard]] bool takes() const {
    const std::lock_guard lock(mutex_);
    return disk_ && fault_.empty();
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
  [[nodiscard]] std::int64_t unreadable() const {
    const std::lock_guard lock(mutex_);
    return static_cast<std::int64_t>(unreadable_.size());
  }
  [[nodiscard]] std::string read_fault() const {
    const std::lock_guard lock(mutex_);
    return unreadable_.empty() ? std::string() : read_fault_;
  }
  [[nodiscard]] std::string fault() const {
    const std::lock_guard lock(mutex_);
    return fault_;
  }

 private:
  [[noreturn]] void fail_to_read(const Place& place, const std::string& why) const {
    ++failed_reads_;
    const std::lock_guard lock(mutex_);
    unreadable_.insert(&place);
    read_fault_ = folder_ + ": " + why;
    throw std::runtime_error("spilled values: " + read_fault_);
  }
  /// Releases the lock while the disk works: a folder on a network may take its time.
  void open(std::unique_lock<std::mutex>& lock) {
    lock.unlock();
    std::shared_ptr<UnnamedFile> disk;
    std::string fault;
    try {
      disk = std::make_shared<UnnamedFile>(folder_);
    } catch (const std::system_error& error) {
      fault = folder_ + ": " + error.code().message();
    }
    lock.lock();
    disk_ = std::move(disk);
    fault_ = std::move(fault);
  }
  /// Whether enough pages are free at the end to be worth a system call.
  [[nodiscard]] bool has_free_end() const { return disk_ && disk_->pages.num_pages() + kWorthwhile <= disk_->length; }
  /// Releases the lock while the disk works: only this thread takes pages.
  void release_the_end(std::unique_lock<std::mutex>& lock) {
    if (!has_free_end()) return;
    const std::uint64_t end = disk_->pages.num_pages();
    lock.unlock();
    disk_->trim(end);
    lock.lock();
    disk_->length = end;
  }
  void write_next(std::unique_lock<std::mutex>& lock) {
    if (waiting_.empty()) return;
    std::shared_ptr<Place> place = waiting_.begin()->second.lock();
    waiting_.erase(waiting_.begin());
    if (!place) return;
    write(*place, lock);
    if (!place->disk) waiting_.emplace(place->turn, place);
    lock.unlock();  // the lock is released before `place`, whose destruction locks it
    place.reset();
    lock.lock();
  }
  /// Releases the lock while the disk works. Afterwards the place is in the file, or there is a fault.
  void write(Place& place, std::unique_lock<std::mutex>& lock) {
    const std::uint64_t page = disk_->pages.take(place.num_pages());
    const bool needs_room = page + place.num_pages() > disk_->length;
    writing_ = true;
    lock.unlock();
    const bool has_room = !needs_room || disk_->has_room_for(leave_free_ + place.size);
    const std::error_code error = has_room ? disk_->write(page, place.bytes) : std::error_code();
    const std::uint32_t checksum = checksum_of(place.bytes);
    lock.lock();
    writing_ = false;
    fault_ = !has_room ? "the disk is nearly full" : error ? folder_ + ": " + error.message() : std::string();
    if (!fault_.empty()) {
      disk_->pages.release(page, place.num_pages());
      if (error && !is_for_lack_of_space(error)) disk_.reset();  // perhaps the disk is gone, and comes back as another
      return;
    }
    disk_->length = std::max(disk_->length, page + place.num_pages());
    place.disk = disk_;
    place.page = page;
    place.checksum = checksum;
    in_memory_ -= place.size;
    in_file_ += place.size;
    place.bytes = PackedValues();
  }

  std::string folder_;
  std::uint64_t leave_free_;
  std::chrono::milliseconds retry_;
  std::shared_ptr<UnnamedFile> disk_;  // nullptr: the folder takes none
  mutable std::mutex mutex_;
  std::condition_variable news_;
  std::map<std::uint64_t, std::weak_ptr<Place>> waiting_;  // by turn
  std::uint64_t turn_ = 0;
  bool writing_ = false;
  bool stopped_ = false;
  std::size_t in_memory_ = 0;  // bytes
  std::size_t in_file_ = 0;    // bytes
  mutable std::atomic<std::int64_t> failed_reads_ = 0;
  std::string fault_;
  mutable std::string read_fault_;
  mutable std::set<const Place*> unreadable_;  // the last read failed
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

SpillFile::SpillFile(const std::string& folder, std::uint64_t leave_free, std::chrono::milliseconds retry)
    : file_(std::make_shared<File>(folder, leave_free, retry)) {
  if (file_->has_folder()) writer_ = std::thread([file = file_.get()] { file->run(); });
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

std::int64_t SpillFile::unreadable() const {
  return file_->unreadable();
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
