#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/terminal/terminal_table.hpp"
#include "procman/sheriff/sheriff.hpp"

namespace curbstone::procman::sheriff {

enum class Action { kWatch, kStatus, kStart, kStop, kRestart, kRun, kTail };

struct SheriffAppOptions {
  Action action = Action::kWatch;
  std::vector<std::string> names;  ///< commands, groups, "everything"; for kRun one script
  std::string config_file;         ///< for kRun
  std::string lcm_url;
  double wait = 30;      ///< s that an order may take
  bool observe = false;  ///< send nothing at all
};

/// A name or a script that does not exist; what() says which.
class UnknownName : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The process `curbstone-sheriff`. Before any order it listens for longer than a second: to what the deputies run, and
/// whether another sheriff commands them. One thread.
class SheriffApp {
 public:
  /// Throws std::runtime_error when the bus cannot be opened.
  explicit SheriffApp(SheriffAppOptions options);
  /// Returns the exit status: 0 done, 1 an order failed or came to no end in time, 3 no deputy answers, 4 another
  /// sheriff gives orders. Throws UnknownName.
  int run();

 private:
  void listen();
  void handle();
  [[nodiscard]] bool gives_orders() const;
  int watch();
  int tail();
  int order();
  int run_script();
  int say_conflict() const;
  [[nodiscard]] std::vector<std::string> named() const;
  [[nodiscard]] std::vector<std::string> picture(const TextStyle& style = {}) const;

  SheriffAppOptions options_;
  LcmBus bus_;
  Sheriff sheriff_;
  bool ordering_ = false;
};

}  // namespace curbstone::procman::sheriff
