#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "server/store/session_store.h"

struct sqlite3;
struct sqlite3_stmt;

namespace rimlight::server {

/// What SQLite refused, with its extended result code.
class SqliteError final : public StoreError {
 public:
  SqliteError(std::string where, std::string found, std::string expected, int code)
      : StoreError(std::move(where), std::move(found), std::move(expected)), code_(code) {}
  int code() const noexcept { return code_; }
  /// Whether the disk, or the size that the store may have, is used up.
  bool is_full() const noexcept;
  /// Whether another process has the file open.
  bool is_in_use() const noexcept;

 private:
  int code_;
};

/// One SQLite connection. One thread at a time; all throw SqliteError naming the file.
class SqliteDatabase {
 public:
  /// Opens or creates a file that can be written. `vfs` names one of SQLite's; empty: its own.
  SqliteDatabase(const std::filesystem::path& file, const std::string& vfs);
  ~SqliteDatabase();
  SqliteDatabase(const SqliteDatabase&) = delete;
  SqliteDatabase& operator=(const SqliteDatabase&) = delete;

  /// Runs statements that return nothing of interest.
  void execute(const std::string& sql);
  /// The first column of the first row; empty when there is none.
  std::string text_of(const std::string& sql);
  std::int64_t integer_of(const std::string& sql);
  /// Takes back a transaction that is open, if one is. Throws nothing.
  void roll_back() noexcept;

  const std::string& file() const { return file_; }
  sqlite3* handle() const { return handle_; }
  /// Throws what the connection says of a failed call.
  [[noreturn]] void fail(int code) const;

 private:
  std::string file_;
  sqlite3* handle_ = nullptr;
};

/// A prepared statement. bind() in order of its parameters, then step(); reset() after the last.
class SqliteStatement {
 public:
  SqliteStatement(SqliteDatabase& database, std::string_view sql);
  ~SqliteStatement();
  SqliteStatement(const SqliteStatement&) = delete;
  SqliteStatement& operator=(const SqliteStatement&) = delete;

  SqliteStatement& bind(std::int64_t value);
  /// `text` must live until reset(): it is not copied.
  SqliteStatement& bind(std::string_view text);
  /// True when there is a row to read.
  bool step();
  void reset() noexcept;
  std::int64_t integer(int column) const;
  std::string text(int column) const;

 private:
  SqliteDatabase& database_;
  sqlite3_stmt* handle_ = nullptr;
  int bound_ = 0;
};

/// Resets a statement at the end of its use, however that comes.
class SqliteUse {
 public:
  explicit SqliteUse(SqliteStatement& statement) : statement_(statement) {}
  SqliteUse(const SqliteUse&) = delete;
  SqliteUse& operator=(const SqliteUse&) = delete;
  ~SqliteUse() { statement_.reset(); }
  SqliteStatement* operator->() const { return &statement_; }

 private:
  SqliteStatement& statement_;
};

}  // namespace rimlight::server
