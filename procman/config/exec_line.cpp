#include "procman/config/exec_line.hpp"

#include <cctype>
#include <cstdlib>

namespace curbstone::procman::config {

namespace {

/// The words of an exec string; nothing if a quote is not closed or a backslash ends the string.
std::optional<std::vector<std::string>> split_words(const std::string& exec) {
  std::vector<std::string> words;
  std::string word;
  bool in_word = false;
  char quote = '\0';
  for (std::size_t i = 0; i < exec.size(); ++i) {
    const char c = exec[i];
    if (c == '\\') {
      if (++i == exec.size()) return std::nullopt;
      word += exec[i];
      in_word = true;
    } else if (quote != '\0') {
      if (c == quote)
        quote = '\0';
      else
        word += c;
    } else if (c == '"' || c == '\'') {
      quote = c;
      in_word = true;  // so that "" is a word
    } else if (std::isspace(static_cast<unsigned char>(c)) != 0) {
      if (in_word) words.push_back(std::exchange(word, {}));
      in_word = false;
    } else {
      word += c;
      in_word = true;
    }
  }
  if (quote != '\0') return std::nullopt;
  if (in_word) words.push_back(word);
  return words;
}

bool is_name_start(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}
bool is_name_rest(char c) {
  return is_name_start(c) || std::isdigit(static_cast<unsigned char>(c)) != 0;
}

/// A variable reference at word[at] == '$': its name and its end. Without a name it is a plain '$'.
struct Reference {
  std::string name;
  std::size_t end = 0;
};
Reference reference_at(const std::string& word, std::size_t at) {
  const bool braced = at + 1 < word.size() && word[at + 1] == '{';
  const std::size_t begin = at + (braced ? 2 : 1);
  std::size_t end = begin;
  if (end < word.size() && is_name_start(word[end])) {
    while (end < word.size() && is_name_rest(word[end])) ++end;
  }
  if (end == begin || (braced && (end == word.size() || word[end] != '}'))) return {};
  return {word.substr(begin, end - begin), end + (braced ? 1 : 0)};
}

}  // namespace

ExecLine parse_exec_line(const std::string& exec,
                         const std::function<std::optional<std::string>(const std::string&)>& lookup) {
  ExecLine line;
  const auto words = split_words(exec);
  if (!words) {
    line.error = "a quote is not closed, or a backslash ends it";
    return line;
  }
  for (const std::string& word : *words) {
    const std::size_t equals = word.find('=');
    if (line.argv.empty() && equals != std::string::npos && equals > 0) {
      line.environment.emplace_back(word.substr(0, equals), word.substr(equals + 1));
      continue;
    }
    std::string expanded;
    for (std::size_t i = 0; i < word.size();) {
      const Reference reference = word[i] == '$' ? reference_at(word, i) : Reference{};
      if (reference.name.empty()) {
        expanded += word[i++];
        continue;
      }
      const auto value = lookup(reference.name);
      if (!value) line.unknown_variables.push_back(reference.name);
      expanded += value ? *value : word.substr(i, reference.end - i);
      i = reference.end;
    }
    line.argv.push_back(std::move(expanded));
  }
  if (line.argv.empty()) line.error = "it names no program";
  return line;
}

std::optional<std::string> from_environment(const std::string& name) {
  const char* value = std::getenv(name.c_str());
  return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

}  // namespace curbstone::procman::config
