#include "libslam/resources/gzip.h"

#include <zlib.h>

#include "libslam/core/error.h"
#include "libslam/files/files.h"

namespace slam::resources {

std::string gzip(std::string_view bytes) {
  z_stream stream{};
  constexpr int kGzipWindow = 15 + 16;
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzipWindow, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw core::IoError("zlib cannot begin to compress");
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib does not write there
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int status = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (status != Z_STREAM_END) throw core::IoError("zlib cannot compress");
  return packed;
}

void writeGzipFile(const std::string& path, std::string_view bytes) {
  files::PendingFile pending(path);
  files::GzipFile packed(pending.path(), path);
  packed.write(bytes);
  packed.close();
  pending.commit();
}

}  // namespace slam::resources
