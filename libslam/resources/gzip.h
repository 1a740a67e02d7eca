#pragma once
#include <string>
#include <string_view>

struct gzFile_s;

namespace slam::resources {

/// RFC 1952, without time and name: the same bytes give the same bytes. Errors: IoError when there
/// is no memory for it.
std::string gzip(std::string_view bytes);

/// The same into a file, written beside and renamed, with no copy in memory. Errors: IoError.
void writeGzipFile(const std::string& path, std::string_view bytes);

/// A file that is packed by gzip as it is written. Its header has neither name nor time: equal content gives
/// equal bytes. Errors: IoError naming `final_path`, under which it will be known.
class GzipFile {
 public:
  GzipFile(const std::string& path, std::string final_path);
  ~GzipFile();
  GzipFile(const GzipFile&) = delete;
  GzipFile& operator=(const GzipFile&) = delete;

  void write(std::string_view bytes);
  /// The rest to the disk.
  void close();

 private:
  [[noreturn]] void fail(int otherwise) const;
  std::string final_path_;
  gzFile_s* file_ = nullptr;
};

}  // namespace slam::resources
