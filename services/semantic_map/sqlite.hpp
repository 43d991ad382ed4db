#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

struct sqlite3;
struct sqlite3_stmt;

namespace curbstone {

/// An SQLite call that failed; `code` is SQLite's primary result code.
class SqliteError : public std::runtime_error {
 public:
  SqliteError(int result, const std::string& what) : std::runtime_error(what), code(result) {}
  int code;
};

/// A connection. Throws SqliteError.
class Sqlite {
 public:
  enum class Mode { kReadOnly, kReadWrite, kCreate };
  Sqlite(const std::string& path, Mode mode);

  void execute(const char* sql);
  [[nodiscard]] std::int64_t integer(const char* sql);  ///< the first column of the first row
  [[nodiscard]] sqlite3* get() const { return db_.get(); }

 private:
  struct Close {
    void operator()(sqlite3* db) const;
  };
  std::unique_ptr<sqlite3, Close> db_;
};

/// A prepared statement: bind() all columns, then step() until false; or run() for what returns no rows.
class Statement {
 public:
  Statement(Sqlite& db, const char* sql);

  template <class... Values>
  Statement& bind(const Values&... values) {
    reset();
    int index = 0;
    (bind_one(++index, values), ...);
    return *this;
  }
  bool step();
  void run() {
    while (step()) {
    }
  }
  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] double real(int column) const;
  [[nodiscard]] std::string text(int column) const;
  [[nodiscard]] std::span<const std::uint8_t> blob(int column) const;  ///< valid until the next step()

 private:
  void reset();
  void bind_one(int index, std::int64_t value);
  void bind_one(int index, std::int32_t value) { bind_one(index, std::int64_t{value}); }
  void bind_one(int index, double value);
  void bind_one(int index, const std::string& value);
  void bind_one(int index, std::span<const std::uint8_t> value);
  void check(int result) const;

  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  sqlite3* db_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

/// BEGIN IMMEDIATE ... COMMIT; rolled back if it is left without commit().
class Transaction {
 public:
  explicit Transaction(Sqlite& db);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  Sqlite& db_;
  bool open_ = true;
};

}  // namespace curbstone
