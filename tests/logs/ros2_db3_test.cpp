#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cstring>
#include <filesystem>

#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"
#include "tests/logs/ros_fixtures.h"

// The database is read and written here with SQLite alone, its CDR by offsets counted by hand.

namespace slam::logs {
namespace {

using mrpt::obs::CObservation2DRangeScan;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Sql {
 public:
  explicit Sql(const std::string& path) { EXPECT_EQ(sqlite3_open(path.c_str(), &database_), SQLITE_OK); }
  ~Sql() { sqlite3_close(database_); }
  Sql(const Sql&) = delete;
  Sql& operator=(const Sql&) = delete;

  /// Rows as texts, blobs as their bytes.
  std::vector<std::vector<std::string>> rows(const std::string& query) {
    std::vector<std::vector<std::string>> found;
    sqlite3_stmt* statement = nullptr;
    EXPECT_EQ(sqlite3_prepare_v2(database_, query.c_str(), -1, &statement, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database_);
    while (sqlite3_step(statement) == SQLITE_ROW) {
      std::vector<std::string> row;
      for (int i = 0; i < sqlite3_column_count(statement); ++i) {
        const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement, i));
        row.emplace_back(bytes == nullptr ? "" : bytes,
                         static_cast<size_t>(sqlite3_column_bytes(statement, i)));
      }
      found.push_back(row);
    }
    sqlite3_finalize(statement);
    return found;
  }
  void run(const std::string& sql) {
    char* error = nullptr;
    EXPECT_EQ(sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, &error), SQLITE_OK) << error;
  }

 private:
  sqlite3* database_ = nullptr;
};

template <class Number>
Number at(const std::string& bytes, size_t offset) {
  Number value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

TEST(Ros2Db3, HasTheTablesOfRosbag2) {
  const testing::TempFolder folder;
  writeAll(drive(3), *bags::createRos2Db3(folder / "log.db3"));
  Sql sql(folder / "log.db3");
  EXPECT_THAT(sql.rows("SELECT name, type, serialization_format FROM topics ORDER BY id"),
              ElementsAre(ElementsAre("/odom", "nav_msgs/msg/Odometry", "cdr"),
                          ElementsAre("/tf", "tf2_msgs/msg/TFMessage", "cdr"),
                          ElementsAre("/ground_truth", "geometry_msgs/msg/PoseStamped", "cdr"),
                          ElementsAre("/tf_static", "tf2_msgs/msg/TFMessage", "cdr"),
                          ElementsAre("/scan", "sensor_msgs/msg/LaserScan", "cdr")));
  EXPECT_THAT(sql.rows("SELECT offered_qos_profiles FROM topics WHERE name='/tf_static'").at(0).at(0),
              HasSubstr("durability: 1\n"));
  EXPECT_THAT(sql.rows("SELECT type, tbl_name FROM sqlite_master WHERE name='timestamp_idx'"),
              ElementsAre(ElementsAre("index", "messages")));
  EXPECT_THAT(sql.rows("SELECT count(*), min(timestamp) FROM messages"),
              ElementsAre(ElementsAre("13", std::to_string(kRosStart_ns))));
}

TEST(Ros2Db3, HasScansInCdr) {
  const testing::TempFolder folder;
  writeAll(drive(2), *bags::createRos2Db3(folder / "log.db3"));
  Sql sql(folder / "log.db3");
  const auto rows = sql.rows(
      "SELECT data FROM messages JOIN topics ON topics.id = topic_id WHERE name = '/scan' ORDER BY "
      "timestamp");
  ASSERT_EQ(rows.size(), 2U);
  const auto& bytes = rows[1][0];
  ASSERT_EQ(bytes.size(), 88U);
  EXPECT_EQ(bytes.substr(0, 4), std::string("\0\1\0\0", 4));
  const size_t start = 4;  // offsets count from after the head
  EXPECT_EQ(at<std::int32_t>(bytes, start), 1'700'000'000);
  EXPECT_EQ(at<std::uint32_t>(bytes, start + 4), 323'456'700U);
  EXPECT_EQ(at<std::uint32_t>(bytes, start + 8), 6U);  // "laser" and its zero
  EXPECT_STREQ(bytes.data() + start + 12, "laser");
  EXPECT_EQ(at<float>(bytes, start + 20), -3.1415927F / 2);  // after 2 bytes of padding
  EXPECT_EQ(at<float>(bytes, start + 24), 3.1415927F / 2);
  EXPECT_FLOAT_EQ(at<float>(bytes, start + 28), 3.1415927F / 6);
  EXPECT_EQ(at<float>(bytes, start + 40), 0);   // range_min
  EXPECT_EQ(at<float>(bytes, start + 44), 30);  // range_max
  EXPECT_EQ(at<std::uint32_t>(bytes, start + 48), 7U);
  EXPECT_EQ(at<float>(bytes, start + 52), 1.1F + 0.001F);
  EXPECT_EQ(at<float>(bytes, start + 60), kInf);
  EXPECT_TRUE(std::isnan(at<float>(bytes, start + 64)));
  EXPECT_EQ(at<float>(bytes, start + 76), 29.99F);
  EXPECT_EQ(at<std::uint32_t>(bytes, start + 80), 0U);  // no intensities
}

TEST(Ros2Db3, HasOdometryInCdr) {
  const testing::TempFolder folder;
  writeAll({odometryObject(kRosStart_ns, 2.5, 0.5)}, *bags::createRos2Db3(folder / "log.db3"));
  Sql sql(folder / "log.db3");
  const auto bytes =
      sql.rows("SELECT data FROM messages JOIN topics ON topics.id = topic_id WHERE name = '/odom'")
          .at(0)
          .at(0);
  const size_t start = 4;
  EXPECT_STREQ(bytes.data() + start + 12, "odom");
  EXPECT_EQ(at<std::uint32_t>(bytes, start + 20), 10U);
  EXPECT_STREQ(bytes.data() + start + 24, "base_link");
  EXPECT_EQ(at<double>(bytes, start + 40), 2.5);  // 34 aligned to 8
  EXPECT_EQ(at<double>(bytes, start + 48), -0.7 * 2.5);
  EXPECT_EQ(at<double>(bytes, start + 80), std::sin(0.25));
  EXPECT_EQ(at<double>(bytes, start + 88), std::cos(0.25));
  EXPECT_EQ(bytes.size(), start + 96 + 78 * sizeof(double));
}

TEST(Ros2Db3, InAFolderComesWithItsMetadata) {
  const testing::TempFolder folder;
  writeAll(drive(2), *bags::createRos2Db3(folder / "bag"));
  EXPECT_TRUE(bags::looksLikeRos2Folder(folder / "bag"));
  EXPECT_FALSE(bags::looksLikeRos2Folder(folder.path()));
  const auto yaml = readBytes(folder / "bag/metadata.yaml");
  EXPECT_THAT(yaml, HasSubstr("storage_identifier: sqlite3\n"));
  EXPECT_THAT(yaml, HasSubstr("nanoseconds_since_epoch: 1700000000123456700\n"));
  EXPECT_THAT(yaml, HasSubstr("  message_count: 9\n"));
  EXPECT_THAT(yaml, HasSubstr("relative_file_paths:\n    - bag_0.db3\n"));
  EXPECT_THAT(testing::errorOf([&] { bags::createRos2Db3(folder / "bag"); }), HasSubstr("bag: exists"));
}

TEST(Ros2Db3, OfSeveralFilesIsReadAsOne) {
  const testing::TempFolder folder;
  auto objects = drive(4);
  writeAll({objects.begin(), objects.begin() + 6}, *bags::createRos2Db3(folder / "a.db3"));
  writeAll({objects.begin() + 6, objects.end()}, *bags::createRos2Db3(folder / "b.db3"));
  writeBytes(
      "rosbag2_bagfile_information:\n  version: 4\n  storage_identifier: sqlite3\n  relative_file_paths:\n"
      "    - a.db3\n    - \"b.db3\"\n  duration:\n    nanoseconds: 0\n  compression_mode: \"\"\n",
      folder / "metadata.yaml");
  const auto source = bags::openRos2Folder(folder.path());
  EXPECT_EQ(readAll(*source).size(), 12U);

  writeAll({objects.begin(), objects.begin() + 6}, *bags::createMcap(folder / "a.mcap"));
  writeBytes("  storage_identifier: mcap\n  relative_file_paths:\n    - a.mcap\n", folder / "metadata.yaml");
  EXPECT_EQ(readAll(*bags::openRos2Folder(folder.path())).size(), 6U);
}

TEST(Ros2Db3, SaysWhatItCannotReadOfAFolder) {
  const testing::TempFolder folder;
  const auto errorWith = [&folder](const std::string& yaml) {
    writeBytes(yaml, folder / "metadata.yaml");
    return testing::errorOf([&] { bags::openRos2Folder(folder.path()); });
  };
  EXPECT_THAT(errorWith("storage_identifier: sqlite3\ncompression_mode: FILE\n"),
              HasSubstr("metadata.yaml: compression_mode: found 'FILE', expected none"));
  EXPECT_THAT(errorWith("storage_identifier: rosbag_v2\n"),
              HasSubstr("storage_identifier: found 'rosbag_v2', expected sqlite3 or mcap"));
  EXPECT_THAT(errorWith("storage_identifier: mcap\n"), HasSubstr("relative_file_paths: found none"));
  EXPECT_THAT(errorWith("storage_identifier: sqlite3\nrelative_file_paths:\n  - gone.db3\n"),
              HasSubstr("gone.db3: no such file"));
}

TEST(Ros2Db3, InOrderOfReceiveTimeWhateverTheRows) {
  const testing::TempFolder folder;
  const auto path = folder / "log.db3";
  writeAll({scanObject(kRosStart_ns, "scan", 1), scanObject(kRosStart_ns + 1000, "scan", 2)},
           *bags::createRos2Db3(path));
  Sql(path).run(
      "UPDATE messages SET timestamp = timestamp - 1000000000 WHERE id = 3; DROP INDEX timestamp_idx");
  const auto scans = only<CObservation2DRangeScan>(readAll(*bags::openRos2Db3(path)));
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[0]->getScanRange(0), 2);
}

TEST(Ros2Db3, WithAnUnfinishedJournalBesideItSaysSo) {
  const testing::TempFolder folder;
  const auto path = folder / "log 100% #1?.db3";
  writeAll(drive(2), *bags::createRos2Db3(path));
  writeBytes("something", path + "-wal");
  const auto source = bags::openRos2Db3(path);
  EXPECT_EQ(readAll(*source).size(), 6U);
  EXPECT_EQ(source->skipped(),
            "what is still in " + path + "-wal (its recorder did not close the bag) is not read");
  EXPECT_EQ(readBytes(path + "-wal"), "something");
  EXPECT_FALSE(std::filesystem::exists(path + "-shm"));
}

TEST(Ros2Db3, IsNotAnyDatabase) {
  const testing::TempFolder folder;
  Sql(folder / "other.db3").run("CREATE TABLE people(name); CREATE VIEW topics AS SELECT * FROM people");
  EXPECT_EQ(testing::errorOf([&] { bags::openRos2Db3(folder / "other.db3"); }),
            (folder / "other.db3") + ": not a ROS 2 bag: an SQLite database without a table 'topics'");
  Sql(folder / "columns.db3").run("CREATE TABLE topics(id); CREATE TABLE messages(id)");
  EXPECT_THAT(testing::errorOf([&] { bags::openRos2Db3(folder / "columns.db3"); }),
              HasSubstr("no such column: name"));
}

TEST(Ros2Db3, OfAnotherSerializationIsPassedOver) {
  const testing::TempFolder folder;
  const auto path = folder / "log.db3";
  writeAll({scanObject(kRosStart_ns, "scan")}, *bags::createRos2Db3(path));
  Sql(path).run("UPDATE topics SET serialization_format = 'rosbag_v2' WHERE name = '/scan'");
  const auto source = bags::openRos2Db3(path);
  EXPECT_EQ(source->next(), nullptr);
  EXPECT_EQ(source->skipped(), "1 message of 1 topic (/scan sensor_msgs/LaserScan serialized as rosbag_v2)");
}

}  // namespace
}  // namespace slam::logs
