#pragma once

#include <string>

namespace curbstone::mapper::journal {

/// Exclusive lock of a journal: a mapper that is started beside a living one must not continue its drive. Held until
/// the process ends, however it ends. Throws JournalError if another process holds it. Where no lock is possible no
/// journal is possible either, which is a separate fault.
class JournalLock {
 public:
  /// `path`: of the journal; the lock is a file beside it.
  explicit JournalLock(const std::string& path);
  ~JournalLock();
  JournalLock(const JournalLock&) = delete;
  JournalLock& operator=(const JournalLock&) = delete;

 private:
  int file_;
};

}  // namespace curbstone::mapper::journal
