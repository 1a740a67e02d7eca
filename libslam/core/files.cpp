#include "libslam/core/files.h"

#include <openssl/evp.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <system_error>

#include "libslam/core/error.h"

namespace slam::core {
namespace fs = std::filesystem;
namespace {

std::ifstream openForReading(const std::string& path) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (!fs::exists(status)) throw InputError(path + ": no such file");
  if (fs::is_directory(status)) throw InputError(path + ": is a folder, expected a file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path + ": cannot be read: " + std::strerror(errno));
  return in;
}

std::string beside(const std::string& path, bool keep_suffix) {
  if (!keep_suffix) return path + ".tmp";
  const fs::path p(path);
  return (p.parent_path() / (p.stem().string() + ".tmp" + p.extension().string())).string();
}

std::string withoutTrailingSlash(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path;
}

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr);
  }
  void add(const void* data, size_t size) { EVP_DigestUpdate(context_.get(), data, size); }
  std::string hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    EVP_DigestFinal_ex(context_.get(), digest.data(), &size);
    const char* kDigits = "0123456789abcdef";
    std::string text;
    for (unsigned int i = 0; i < size; ++i) {
      text += kDigits[digest[i] >> 4];
      text += kDigits[digest[i] & 15];
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

void requireReadableFile(const std::string& path) {
  openForReading(path);
}

std::string readTextFile(const std::string& path) {
  auto in = openForReading(path);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void writeFileAtomically(const std::string& path, std::string_view content) {
  GrowingFile file(path);
  file.append(content);
  file.commit();
}

GrowingFile::GrowingFile(const std::string& final_path)
    : final_path_(final_path), file_(final_path), out_(file_.path(), std::ios::binary | std::ios::trunc) {
  if (!out_) throw IoError(final_path_ + ": cannot be written: " + std::strerror(errno));
}

void GrowingFile::append(std::string_view text) {
  out_.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!out_) throw IoError(final_path_ + ": writing failed: " + std::strerror(errno));
}

void GrowingFile::commit() {
  out_.close();
  if (!out_) throw IoError(final_path_ + ": writing failed: " + std::strerror(errno));
  file_.commit();
}

PendingFile::PendingFile(std::string final_path, bool keep_suffix)
    : final_path_(std::move(final_path)), temporary_path_(beside(final_path_, keep_suffix)) {}

PendingFile::~PendingFile() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove(temporary_path_, ignored);
}

void PendingFile::commit() {
  std::error_code error;
  fs::rename(temporary_path_, final_path_, error);
  if (error) throw IoError(final_path_ + ": cannot be written: " + error.message());
  committed_ = true;
}

PendingFolder::PendingFolder(std::string final_path, bool overwrite)
    : final_path_(withoutTrailingSlash(std::move(final_path))),
      temporary_path_(final_path_ + ".tmp"),
      overwrite_(overwrite) {
  refuseToOverwrite(final_path_, overwrite_);
  std::error_code error;
  if (fs::exists(final_path_) && !fs::is_directory(final_path_))
    throw InputError(final_path_ + ": is a file, expected a folder");
  if (fs::exists(final_path_) && !fs::is_empty(final_path_) && !fs::exists(final_path_ + "/manifest.json"))
    throw InputError(final_path_ +
                     ": holds other files and no manifest.json, so it is not replaced; remove it first");
  fs::remove_all(temporary_path_, error);
  fs::create_directories(temporary_path_, error);
  if (error) throw IoError(final_path_ + ": cannot be made: " + error.message());
}

PendingFolder::~PendingFolder() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove_all(temporary_path_, ignored);
}

void PendingFolder::commit() {
  std::error_code error;
  if (overwrite_) fs::remove_all(final_path_, error);
  fs::rename(temporary_path_, final_path_, error);
  if (error) throw IoError(final_path_ + ": cannot be written: " + error.message());
  committed_ = true;
}

ScratchFolder::ScratchFolder() {
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  path_ = ((error ? fs::path("/tmp") : parent) / "rasterslam-XXXXXX").string();
  if (mkdtemp(path_.data()) == nullptr)
    throw IoError(path_ + ": this folder cannot be made: " + std::strerror(errno));
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string findProgram(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  std::error_code error;
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::string file = (fs::path(folder.empty() ? "." : folder) / name).string();
    if (access(file.c_str(), X_OK) == 0 && fs::is_regular_file(file, error)) return file;
  }
  return "";
}

void refuseToOverwrite(const std::string& path, bool overwrite) {
  if (!overwrite && fs::exists(path)) throw InputError(path + ": exists; give --overwrite to replace it");
}

std::string sha256(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes.data(), bytes.size());
  return hash.hex();
}

std::string fileSha256(const std::string& path) {
  auto in = openForReading(path);
  Sha256 hash;
  std::array<char, 1 << 16> buffer{};
  while (in.read(buffer.data(), buffer.size()) || in.gcount() > 0)
    hash.add(buffer.data(), static_cast<size_t>(in.gcount()));
  return hash.hex();
}

}  // namespace slam::core
