#pragma once

#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "common/log/log_reader.hpp"
#include "common/message_types/field_values.hpp"

namespace curbstone::log_tool {

/// Writes the messages of a channel as CSV (RFC 4180, but lines end with a newline only). The first column is the time
/// of the record. A row is a message, with its fields of fixed size. With `elements`, a row is one element of the
/// variable-length arrays that share the longest length, after the fields of fixed size.
class ChannelTable {
 public:
  ChannelTable(std::ostream& out, bool elements) : out_(out), elements_(elements) {}

  void write(const LogEvent& event);
  [[nodiscard]] std::int64_t rows() const { return rows_; }
  [[nodiscard]] std::int64_t undecodable() const { return undecodable_; }
  /// Fields without a column.
  [[nodiscard]] const std::set<std::string>& left_out() const { return left_out_; }

 private:
  void begin(const MessageType& type);
  void write_row(const LogEvent& event, const std::vector<std::string>& fixed, std::size_t element);
  void write_header(const std::vector<NamedValue>& values);

  std::ostream& out_;
  bool elements_;
  const MessageType* type_ = nullptr;
  std::set<std::string> variable_;          // fields of variable length
  std::vector<std::string> array_columns_;  // of these, those with a column
  std::set<std::string> left_out_;
  bool header_written_ = false;
  std::vector<std::vector<std::string>> arrays_;  // of the present message, one per column
  std::int64_t rows_ = 0;
  std::int64_t undecodable_ = 0;
};

}  // namespace curbstone::log_tool
