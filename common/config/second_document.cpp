#include "common/config/second_document.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <sstream>

#include "common/config/config.hpp"

namespace curbstone {

namespace {

/// The start of the last document, and whether it has any content.
class DocumentStart final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override {
    mark_ = mark;
    is_empty_ = true;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override { is_empty_ = false; }
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {
    is_empty_ = false;
  }
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    is_empty_ = false;
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    is_empty_ = false;
  }
  void OnMapEnd() override {}

  [[nodiscard]] const YAML::Mark& mark() const { return mark_; }
  [[nodiscard]] bool is_empty() const { return is_empty_; }

 private:
  YAML::Mark mark_;
  bool is_empty_ = true;
};

}  // namespace

void refuse_second_document(const std::string& text, const std::string& name) {
  std::istringstream in(text);
  YAML::Parser parser(in);
  DocumentStart document;
  parser.HandleNextDocument(document);
  for (int last = document.mark().pos; parser.HandleNextDocument(document); last = document.mark().pos) {
    if (!document.is_empty())
      throw ConfigError(fmt::format("{}:{}: a second YAML document (after ---), which nobody would read", name,
                                    document.mark().line + 1));
    // At a comma yaml-cpp 0.7 reads empty documents endlessly (so does LoadAll).
    if (document.mark().pos == last)
      throw ConfigError(fmt::format("{}:{}: no YAML from here on", name, document.mark().line + 1));
  }
}

}  // namespace curbstone
