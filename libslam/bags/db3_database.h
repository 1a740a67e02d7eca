#pragma once
#include <sqlite3.h>

#include <memory>

namespace slam::bags {

// SQLite's handles, closed when they go. The tables of a bag: github.com/ros2/rosbag2,
// rosbag2_storage_sqlite3, sqlite_storage.cpp.

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
struct FinishStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, FinishStatement>;

}  // namespace slam::bags
