#include "common/config/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <type_traits>

#include "common/config/standard_streams.hpp"
#include "common/config/version.hpp"

namespace curbstone {

namespace {

/// CLI11 reads -1 as the largest unsigned number, and a number that does not fit into 64 bits as the nearest one that
/// does.
template <class Integer>
std::string misfit(const std::string& text) {
  errno = 0;
  if constexpr (std::is_signed_v<Integer>) {
    std::strtoll(text.c_str(), nullptr, 0);
  } else {
    std::strtoull(text.c_str(), nullptr, 0);
    if (text.find('-') != std::string::npos) errno = ERANGE;
  }
  return errno == ERANGE ? "Value " + text + " out of range" : "";
}

/// No option accepts nan or inf, and range checks do not reject nan.
std::string not_finite(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return *end == '\0' && !std::isfinite(value) ? "Value " + text + " is no number" : "";
}

}  // namespace

CommandOption& CommandOption::required() {
  option_->required();
  return *this;
}

CommandOption& CommandOption::shows_default() {
  option_->capture_default_str();
  return *this;
}

CommandOption& CommandOption::within(int min, int max) {
  option_->check(CLI::Range(min, max));
  return *this;
}

CommandOption& CommandOption::within(double min, double max) {
  option_->check(CLI::Range(min, max));
  return *this;
}

CommandOption& CommandOption::not_negative() {
  option_->check(CLI::NonNegativeNumber);
  return *this;
}

CommandOption& CommandOption::one_of(std::vector<std::string> words) {
  option_->check(CLI::IsMember(std::move(words)));
  return *this;
}

CommandOption& CommandOption::existing_folder() {
  option_->check(CLI::ExistingDirectory);
  return *this;
}

CommandOption& CommandOption::comma_separated() {
  option_->delimiter(',');
  return *this;
}

CommandOption& CommandOption::one_each() {
  option_->allow_extra_args(false);
  return *this;
}

CommandOption& CommandOption::excludes(const CommandOption& other) {
  option_->excludes(other.option_);
  return *this;
}

CommandLine::CommandLine(const std::string& description, const std::string& program)
    : app_(std::make_unique<CLI::App>(description, program)) {
  app_->set_version_flag("--version", version());
}

CommandLine::~CommandLine() = default;

CommandOption CommandLine::argument(const std::string& name, std::string& value, const std::string& help) {
  return listed(app_->add_option(name, value, help));
}

template <CommandValue T>
CommandOption CommandLine::option(const std::string& names, T& value, const std::string& help) {
  CLI::Option* const option = app_->add_option(names, value, help);
  if constexpr (std::same_as<T, std::int64_t>) option->check(misfit<std::int64_t>);
  if constexpr (std::same_as<T, std::uint64_t> || std::same_as<T, std::vector<std::uint64_t>>)
    option->check(misfit<std::uint64_t>);
  if constexpr (std::same_as<T, double> || std::same_as<T, std::vector<double>>) option->check(not_finite);
  return listed(option);
}

template CommandOption CommandLine::option(const std::string&, std::string&, const std::string&);
template CommandOption CommandLine::option(const std::string&, double&, const std::string&);
template CommandOption CommandLine::option(const std::string&, int&, const std::string&);
template CommandOption CommandLine::option(const std::string&, std::int64_t&, const std::string&);
template CommandOption CommandLine::option(const std::string&, std::uint64_t&, const std::string&);
template CommandOption CommandLine::option(const std::string&, std::vector<std::string>&, const std::string&);
template CommandOption CommandLine::option(const std::string&, std::vector<double>&, const std::string&);
template CommandOption CommandLine::option(const std::string&, std::vector<std::uint64_t>&, const std::string&);

CommandOption CommandLine::flag(const std::string& names, bool& value, const std::string& help) {
  return listed(app_->add_flag(names, value, help));
}

std::optional<int> CommandLine::read(int argc, const char* const* argv) {
  guard_standard_streams();
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app_->exit(error) == 0 ? 0 : 2;
  }
  return std::nullopt;
}

int CommandLine::refuse(const std::string& what) const {
  app_->exit(CLI::ValidationError(what));
  return 2;
}

bool CommandLine::given(const std::string& name) const {
  return app_->count(name) > 0;
}

CommandOption CommandLine::word_option(const std::string& names, const std::vector<std::string>& words,
                                       const std::string& help, std::function<void(std::size_t)> choose) {
  const std::function<void(const std::string&)> look_up = [words, choose = std::move(choose)](const std::string& word) {
    choose(static_cast<std::size_t>(std::find(words.begin(), words.end(), word) - words.begin()));
  };
  return listed(app_->add_option_function(names, look_up, help)->check(CLI::IsMember(words)));
}

CommandOption CommandLine::listed(CLI::Option* option) const {
  if (!heading_.empty()) option->group(heading_);
  return CommandOption(*option);
}

}  // namespace curbstone
