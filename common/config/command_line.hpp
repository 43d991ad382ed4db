#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace curbstone {

/// A type that an option can write to. A vector takes as many values as are given.
template <class T>
concept CommandValue = std::same_as<T, std::string> || std::same_as<T, double> || std::same_as<T, int> ||
    std::same_as<T, std::int64_t> || std::same_as<T, std::uint64_t> || std::same_as<T, std::vector<std::string>> ||
    std::same_as<T, std::vector<double>> || std::same_as<T, std::vector<std::uint64_t>>;

/// One option of a CommandLine, which owns it: sets which values it accepts. In a vector, each value must comply.
class CommandOption {
 public:
  explicit CommandOption(CLI::Option& option) : option_(&option) {}

  CommandOption& required();
  /// Shows the variable's present value in the help as the default.
  CommandOption& shows_default();
  /// Inclusive bounds.
  CommandOption& within(int min, int max);
  CommandOption& within(double min, double max);
  CommandOption& not_negative();
  CommandOption& one_of(std::vector<std::string> words);
  CommandOption& existing_folder();
  /// A list takes "a,b" as two values.
  CommandOption& comma_separated();
  /// A list takes one value each time the option is given. The next word is an argument again.
  CommandOption& one_each();
  CommandOption& excludes(const CommandOption& other);

 private:
  CLI::Option* option_;
};

/// A program's command line. Its options are declared first and then read into the caller's variables, whose initial
/// values are the defaults. --help and --version always exist.
///
///     std::string log;
///     double seconds = 60;
///     CommandLine line("What it does", "curbstone example");
///     line.argument("log", log, "A log of lcm-logger").required();
///     line.option("--seconds", seconds, "Length of the drive").within(0.1, 36000.0).shows_default();
///     if (const auto status = line.read(argc, argv)) return *status;
///
/// CLI11 costs seconds in each file that includes it: only command_line.cpp does.
class CommandLine {
 public:
  /// `program` appears in the usage line; by default it is argv[0].
  explicit CommandLine(const std::string& description, const std::string& program = "");
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// A positional argument.
  CommandOption argument(const std::string& name, std::string& value, const std::string& help);
  /// `names`: "--seconds", or "-i,--id".
  template <CommandValue T>
  CommandOption option(const std::string& names, T& value, const std::string& help = "");
  /// `value` becomes true if the flag is given.
  CommandOption flag(const std::string& names, bool& value, const std::string& help);
  /// Accepts one of some words, each of which stands for a value of an enumeration.
  template <class Enum>
  CommandOption choice(const std::string& names, Enum& value, const std::vector<std::pair<std::string, Enum>>& choices,
                       const std::string& help) {
    std::vector<std::string> words;
    for (const auto& [word, meaning] : choices) words.push_back(word);
    return word_option(names, words, help, [&value, choices](std::size_t k) { value = choices[k].second; });
  }
  /// The help shows the options declared after this call under this heading.
  void heading(const std::string& heading) { heading_ = heading; }

  /// Reads the arguments. Returns nothing if the program should continue. Otherwise it has printed help, version or an
  /// error, and returns the exit status: 0, or 2 for an error.
  [[nodiscard]] std::optional<int> read(int argc, const char* const* argv);
  /// For conditions on several options: prints the error as read() does and returns the exit status.
  [[nodiscard]] int refuse(const std::string& what) const;
  /// Whether the option was given on the command line.
  [[nodiscard]] bool given(const std::string& name) const;

 private:
  CommandOption word_option(const std::string& names, const std::vector<std::string>& words, const std::string& help,
                            std::function<void(std::size_t)> choose);
  CommandOption listed(CLI::Option* option) const;

  std::unique_ptr<CLI::App> app_;
  std::string heading_;
};

}  // namespace curbstone
