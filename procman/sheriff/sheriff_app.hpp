#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/terminal/terminal_table.hpp"
#include "procman/config/config.hpp"
#include "procman/sheriff/sheriff.hpp"

namespace curbstone::procman::sheriff {

enum class Action { kWatch, kStatus, kStart, kStop, kRestart, kRun, kTail };

struct SheriffAppOptions {
  Action action = Action::kWatch;
  std::vector<std::string> names;  ///< commands, groups, "everything"; for kRun a script
  std::string config_file;         ///< for kRun
  std::string lcm_url;
  double wait = 30;      ///< s within which an order must be done
  bool observe = false;  ///< send nothing
};

/// A name or a script that does not exist; what() names it.
class UnknownName : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The process `curbstone-sheriff`. Before any order it listens for more than a second, to the deputies' reports and
/// for another sheriff that commands them. One thread.
class SheriffApp {
 public:
  /// Throws std::runtime_error if the bus cannot be opened.
  explicit SheriffApp(SheriffAppOptions options);
  /// Returns the exit status: 0 done, 1 an order failed or timed out, 3 no deputy answers, 4 another sheriff gives
  /// orders. Throws UnknownName.
  int run();

 private:
  void listen();
  void handle();
  [[nodiscard]] bool gives_orders() const;
  int watch();
  int tail();
  int order();
  int run_script();
  [[nodiscard]] config::Config script_config() const;
  [[nodiscard]] bool is_under_way(const std::string& id) const;
  [[nodiscard]] bool fulfils(const std::string& id, config::WaitStatus wait, bool asked) const;
  [[nodiscard]] std::int64_t deadline() const;
  int say_conflict() const;
  [[nodiscard]] std::vector<std::string> named() const;
  [[nodiscard]] std::vector<std::string> picture(const TextStyle& style = {}) const;

  SheriffAppOptions options_;
  LcmBus bus_;
  Sheriff sheriff_;
  bool ordering_ = false;
};

}  // namespace curbstone::procman::sheriff
