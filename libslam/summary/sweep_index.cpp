#include "libslam/summary/sweep_index.h"

#include <sqlite3.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "libslam/core/error.h"
#include "libslam/files/files.h"

namespace slam::summary {
namespace {

/// A new database, and how it says that something went wrong.
class Database {
 public:
  Database(const std::string& file, std::string name) : name_(std::move(name)) {
    sqlite3* opened = nullptr;
    const int code =
        sqlite3_open_v2(file.c_str(), &opened, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
    handle_.reset(opened);
    check(code);
  }

  void execute(const char* sql) { check(sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr)); }

  sqlite3* handle() const { return handle_.get(); }
  void check(int code) const {
    if (code == SQLITE_OK || code == SQLITE_DONE || code == SQLITE_ROW) return;
    throw core::IoError(name_ + ": cannot be written: " + sqlite3_errmsg(handle_.get()));
  }

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
  };
  std::string name_;
  std::unique_ptr<sqlite3, Close> handle_;
};

class Insertion {
 public:
  Insertion(const Database& database, const char* sql) : database_(database) {
    sqlite3_stmt* prepared = nullptr;
    database.check(sqlite3_prepare_v2(database.handle(), sql, -1, &prepared, nullptr));
    statement_.reset(prepared);
  }

  template <class... Values>
  void operator()(const Values&... values) {
    int place = 0;
    (database_.check(bind(++place, values)), ...);
    database_.check(sqlite3_step(statement_.get()));
    database_.check(sqlite3_reset(statement_.get()));
  }

 private:
  int bind(int place, const std::string& text) {
    return sqlite3_bind_text(statement_.get(), place, text.data(), static_cast<int>(text.size()),
                             SQLITE_TRANSIENT);
  }
  int bind(int place, double value) {
    if (!std::isfinite(value)) return sqlite3_bind_null(statement_.get(), place);
    return sqlite3_bind_double(statement_.get(), place, value);
  }
  int bind(int place, std::uint64_t value) {
    return sqlite3_bind_int64(statement_.get(), place, static_cast<sqlite3_int64>(value));
  }

  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  const Database& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

void fill(Database& database, const sweep::SweepPlan& plan, const SweepResults& results) {
  // Nobody sees the file before it is whole.
  database.execute("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; BEGIN");
  database.execute(
      "CREATE TABLE logs(id TEXT PRIMARY KEY, world TEXT, robot TEXT, lidar TEXT, odometry TEXT, strategy "
      "TEXT, "
      "fault TEXT, seed INTEGER) WITHOUT ROWID;"
      "CREATE TABLE runs(id TEXT PRIMARY KEY, log TEXT, seed INTEGER, method TEXT, parameters TEXT, status "
      "TEXT, "
      "message TEXT, folder TEXT) WITHOUT ROWID;"
      "CREATE TABLE figures(run TEXT, key TEXT, value REAL, PRIMARY KEY(run, key)) WITHOUT ROWID");
  Insertion log_row(database, "INSERT INTO logs VALUES(?, ?, ?, ?, ?, ?, ?, ?)");
  for (const auto& log : plan.logs)
    log_row(log.id, log.world, log.robot, log.lidar, log.odometry, log.strategy, log.fault, log.seed);
  Insertion run_row(database, "INSERT INTO runs VALUES(?, ?, ?, ?, ?, ?, ?, ?)");
  Insertion figure_row(database, "INSERT INTO figures VALUES(?, ?, ?)");
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    const auto& run = plan.runs[i];
    const auto& result = results[i];
    run_row(run.id, plan.logs[run.log].id, run.seed, run.method, run.parameters,
            result ? result->status : std::string("missing"), result ? result->message : std::string(),
            "cells/" + run.id);
    if (!result) continue;
    for (const auto& [key, value] : result->figures) figure_row(run.id, key, value);
  }
  database.execute("COMMIT");
}

}  // namespace

void writeSweepIndex(const sweep::SweepPlan& plan, const SweepResults& results, const std::string& path) {
  files::PendingFile file(path);
  std::error_code ignored;
  std::filesystem::remove(file.path(), ignored);
  {
    Database database(file.path(), path);
    fill(database, plan, results);
  }
  file.commit();
}

}  // namespace slam::summary
