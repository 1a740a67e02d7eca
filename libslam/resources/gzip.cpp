#include "libslam/resources/gzip.h"

#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <utility>

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
  GzipFile packed(pending.path(), path);
  packed.write(bytes);
  packed.close();
  pending.commit();
}

GzipFile::GzipFile(const std::string& path, std::string final_path) : final_path_(std::move(final_path)) {
  errno = 0;
  file_ = gzopen(path.c_str(), "wb");
  if (!file_) fail(ENOMEM);
}

GzipFile::~GzipFile() {
  if (file_) gzclose(file_);
}

void GzipFile::fail(int otherwise) const {
  throw core::IoError(final_path_ + ": cannot be written: " + std::strerror(errno ? errno : otherwise));
}

void GzipFile::write(std::string_view bytes) {
  constexpr size_t kAtOnce = 1U << 20U;  // zlib counts in ints
  for (size_t at = 0; at < bytes.size(); at += kAtOnce) {
    const auto piece = bytes.substr(at, kAtOnce);
    errno = 0;
    if (gzwrite(file_, piece.data(), static_cast<unsigned>(piece.size())) != static_cast<int>(piece.size()))
      fail(EIO);
  }
}

void GzipFile::close() {
  errno = 0;
  if (gzclose(std::exchange(file_, nullptr)) != Z_OK) fail(EIO);
}

}  // namespace slam::resources
