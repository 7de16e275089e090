#include "server/store/sqlite_database.h"

#include <sqlite3.h>

#include <utility>

namespace rimlight::server {
namespace {

/// What would have been right, for a result code.
std::string expected_instead(int code) {
  switch (code & 0xff) {  // the primary code
    case SQLITE_FULL:
      return "room for the store";
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "a store that no other server has open";
    case SQLITE_NOTADB:
    case SQLITE_CORRUPT:
      return "a whole store of sessions: move it away, or bring a copy back";
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_CANTOPEN:
      return "a file that can be written";
    default:
      return "a disk that reads and writes";
  }
}

}  // namespace

bool SqliteError::is_full() const noexcept { return (code_ & 0xff) == SQLITE_FULL; }

bool SqliteError::is_in_use() const noexcept { return (code_ & 0xff) == SQLITE_BUSY; }

SqliteDatabase::SqliteDatabase(const std::filesystem::path& file, const std::string& vfs)
    : file_(file.string()) {
  const int flags =
      SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE;
  const int code =
      sqlite3_open_v2(file_.c_str(), &handle_, flags, vfs.empty() ? nullptr : vfs.c_str());
  const bool read_only = code == SQLITE_OK && sqlite3_db_readonly(handle_, "main") == 1;
  if (code == SQLITE_OK && !read_only) return;
  const std::string found = read_only ? "a file for reading only" : sqlite3_errstr(code);
  sqlite3_close(handle_);
  const int reason = read_only ? SQLITE_READONLY : code;
  throw SqliteError(file_, found, expected_instead(reason), reason);
}

SqliteDatabase::~SqliteDatabase() { sqlite3_close(handle_); }

void SqliteDatabase::execute(const std::string& sql) {
  const int code = sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code);
}

std::string SqliteDatabase::text_of(const std::string& sql) {
  SqliteStatement statement(*this, sql);
  return statement.step() ? statement.text(0) : std::string();
}

std::int64_t SqliteDatabase::integer_of(const std::string& sql) {
  SqliteStatement statement(*this, sql);
  return statement.step() ? statement.integer(0) : 0;
}

void SqliteDatabase::roll_back() noexcept {
  // SQLite has done it itself after some failures; one of the rollback changes nothing more.
  if (sqlite3_get_autocommit(handle_) == 0) {
    sqlite3_exec(handle_, "ROLLBACK", nullptr, nullptr, nullptr);
  }
}

void SqliteDatabase::fail(int code) const {
  throw SqliteError(file_, sqlite3_errmsg(handle_), expected_instead(code), code);
}

SqliteStatement::SqliteStatement(SqliteDatabase& database, std::string_view sql)
    : database_(database) {
  const int code = sqlite3_prepare_v3(database.handle(), sql.data(), static_cast<int>(sql.size()),
                                      SQLITE_PREPARE_PERSISTENT, &handle_, nullptr);
  if (code != SQLITE_OK) database.fail(code);
}

SqliteStatement::~SqliteStatement() { sqlite3_finalize(handle_); }

SqliteStatement& SqliteStatement::bind(std::int64_t value) {
  const int code = sqlite3_bind_int64(handle_, ++bound_, value);
  if (code != SQLITE_OK) database_.fail(code);
  return *this;
}

SqliteStatement& SqliteStatement::bind(std::string_view text) {
  const int code =
      sqlite3_bind_text64(handle_, ++bound_, text.data(), text.size(), SQLITE_STATIC, SQLITE_UTF8);
  if (code != SQLITE_OK) database_.fail(code);
  return *this;
}

bool SqliteStatement::step() {
  const int code = sqlite3_step(handle_);
  if (code != SQLITE_ROW && code != SQLITE_DONE) database_.fail(code);
  return code == SQLITE_ROW;
}

void SqliteStatement::reset() noexcept {
  sqlite3_reset(handle_);
  sqlite3_clear_bindings(handle_);
  bound_ = 0;
}

std::int64_t SqliteStatement::integer(int column) const {
  return sqlite3_column_int64(handle_, column);
}

std::string SqliteStatement::text(int column) const {
  const auto* const bytes = static_cast<const char*>(sqlite3_column_blob(handle_, column));
  const int size = sqlite3_column_bytes(handle_, column);
  return bytes == nullptr ? std::string() : std::string(bytes, static_cast<std::size_t>(size));
}

}  // namespace rimlight::server
