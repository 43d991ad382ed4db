#pragma once

#include <future>
#include <optional>
#include <utility>

namespace curbstone::mapper::local_map {

/// The result of a computation that takes longer than a scan may. A thread of its own computes it, and it is taken a
/// fixed number of scans later: if it is there sooner it waits, if it is late the caller does. So what follows depends
/// on the scans alone, and a replay does the same as the vehicle. One caller.
template <class Result>
class DelayedResult {
 public:
  /// `threaded` false: the result is computed when it is taken.
  explicit DelayedResult(bool threaded) : policy_(threaded ? std::launch::async : std::launch::deferred) {}
  ~DelayedResult() { cancel(); }
  DelayedResult(const DelayedResult&) = delete;
  DelayedResult& operator=(const DelayedResult&) = delete;

  /// Begins a computation. The `scans`-th call of next_scan() from now on returns its result. None may be under way.
  template <class Compute>
  void begin(int scans, Compute compute) {
    scans_left_ = scans;
    under_way_ = std::async(policy_, std::move(compute));
  }
  [[nodiscard]] bool is_under_way() const { return under_way_.valid(); }
  /// To be called once a scan while a computation is under way. Returns its result if this is its scan.
  [[nodiscard]] std::optional<Result> next_scan() { return --scans_left_ > 0 ? std::nullopt : take(); }
  /// The result at once, as no scan follows; nothing if no computation is under way.
  [[nodiscard]] std::optional<Result> take() {
    if (!under_way_.valid()) return std::nullopt;
    return under_way_.get();
  }
  /// Drops the computation that is under way, if there is one.
  void cancel() {
    if (under_way_.valid() && policy_ == std::launch::async) under_way_.wait();
    under_way_ = {};
  }

 private:
  std::launch policy_;
  std::future<Result> under_way_;
  int scans_left_ = 0;
};

}  // namespace curbstone::mapper::local_map
