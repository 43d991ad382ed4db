#pragma once

#include <string>
#include <utility>
#include <vector>

namespace curbstone::doctor::checks {

/// The result of one check. A finding has a fix: what to do about it, with a command if there is one.
struct Verdict {
  enum class Kind {
    kGood,
    kFinding,
    kUnknown  ///< could not be checked; `fix` says how it can be
  };
  Kind kind = Kind::kGood;
  std::string check;  ///< "route"
  std::string what;   ///< one line
  std::string fix;    ///< one line; empty if the check is good
};
using Verdicts = std::vector<Verdict>;

[[nodiscard]] inline Verdict good(std::string check, std::string what) {
  return {Verdict::Kind::kGood, std::move(check), std::move(what), {}};
}
[[nodiscard]] inline Verdict finding(std::string check, std::string what, std::string fix) {
  return {Verdict::Kind::kFinding, std::move(check), std::move(what), std::move(fix)};
}
[[nodiscard]] inline Verdict unknown(std::string check, std::string what, std::string fix) {
  return {Verdict::Kind::kUnknown, std::move(check), std::move(what), std::move(fix)};
}

}  // namespace curbstone::doctor::checks
