#pragma once

#include <string>

namespace curbstone::mapper::journal {

/// That no other process keeps this journal: a mapper that was started beside a living one must not go on with its
/// drive. Held until the process ends, however it ends. Throws JournalError where another holds it; where there can be
/// no lock there can be no journal either, which is a fault of its own.
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
