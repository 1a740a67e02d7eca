#include "libslam/files/files.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "libslam/core/error.h"

namespace slam::files {
namespace fs = std::filesystem;
namespace {

std::ifstream openForReading(const std::string& path) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (!fs::exists(status)) throw core::InputError(path + ": no such file");
  if (fs::is_directory(status)) throw core::InputError(path + ": is a folder, expected a file");
  // One without an end would be read for ever, one without a writer waited for.
  if (!fs::is_regular_file(status)) throw core::InputError(path + ": is a device or a pipe, expected a file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw core::InputError(path + ": cannot be read: " + std::strerror(errno));
  return in;
}

constexpr const char* kBeside = ".rasterslam-";
constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz0123456789";
constexpr std::size_t kDrawnLetters = 6;

/// Six digits for where the number of a process means that process: this start of this machine, this
/// namespace (container).
std::string machineMark() {
  std::string text;
  std::getline(std::ifstream("/proc/sys/kernel/random/boot_id"), text);
  std::error_code error;
  text += fs::read_symlink("/proc/self/ns/pid", error).string();
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  char digits[8];
  std::snprintf(digits, sizeof digits, "%06x", static_cast<unsigned>(hash >> 40));
  return digits;
}

/// A name beside a path that ends by `suffix`, "NAME.rasterslam-MACHINE-PROCESS-XXXXXX", made by `make` (0,
/// or -1 with errno) under a name that was not there before.
template <class Make>
std::string madeBeside(const std::string& path, const std::string& suffix, const Make& make) {
  const std::string begin = path.substr(0, path.size() - suffix.size()) + kBeside + machineMark() + "-" +
                            std::to_string(getpid()) + "-";
  std::random_device draw;
  while (true) {
    std::string name = begin;
    for (std::size_t i = 0; i < kDrawnLetters; ++i) name += kLetters[draw() % kLetters.size()];
    name += suffix;
    if (make(name.c_str()) == 0) return name;
    if (errno != EEXIST) throw core::IoError(path + ": cannot be written: " + std::strerror(errno));
  }
}

/// Whether a name is one that madeBeside() gave on this machine to a process that does not live any more.
bool isLeftover(std::string_view name, const std::string& begin, const std::string& suffix) {
  if (name.size() < begin.size() + suffix.size() || name.substr(0, begin.size()) != begin ||
      name.substr(name.size() - suffix.size()) != suffix)
    return false;
  name = name.substr(begin.size(), name.size() - begin.size() - suffix.size());
  const std::size_t dash = name.find('-');
  if (dash == 0 || dash > 9 || name.size() != dash + 1 + kDrawnLetters ||
      name.substr(0, dash).find_first_not_of("0123456789") != std::string_view::npos ||
      name.substr(dash + 1).find_first_not_of(kLetters) != std::string_view::npos)
    return false;
  const int process = std::atoi(std::string(name.substr(0, dash)).c_str());
  return process > 0 && kill(process, 0) != 0 && errno == ESRCH;
}

/// What processes of this machine that were killed have left beside a path.
std::vector<fs::path> leftoversOf(const std::string& path, const std::string& suffix) {
  const fs::path whole = fs::absolute(path);
  const std::string name = whole.filename().string();
  const std::string begin = name.substr(0, name.size() - suffix.size()) + kBeside + machineMark() + "-";
  std::vector<fs::path> leftovers;
  std::error_code error;
  for (fs::directory_iterator it(whole.parent_path(), error), end; !error && it != end; it.increment(error))
    if (isLeftover(it->path().filename().string(), begin, suffix)) leftovers.push_back(it->path());
  return leftovers;
}

/// Throws for what --overwrite must not replace, as root could: a device, a pipe, a socket.
void requireReplaceable(const std::string& path) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
    throw core::InputError(path + ": is a device or a pipe, expected a file or folder that can be replaced");
}

/// A new file beside; nobody else has its name.
std::string makeBeside(const std::string& path, bool keep_suffix) {
  requireReplaceable(path);
  if (fs::is_directory(path)) throw core::InputError(path + ": is a folder, expected a file");
  const fs::path p(path);
  const std::string suffix = keep_suffix ? p.extension().string() : "";
  std::error_code error;
  for (const auto& leftover : leftoversOf(path, suffix))
    if (fs::is_regular_file(fs::symlink_status(leftover, error))) fs::remove(leftover, error);
  return madeBeside(path, suffix, [](const char* name) {
    const int file = open(name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    return file < 0 ? -1 : close(file);
  });
}

/// Removes what processes of ours that were killed have left beside a folder. REQUIRES its lock.
void removeLeftovers(const std::string& folder) {
  std::error_code error;
  for (const auto& leftover : leftoversOf(folder, ""))
    if (fs::is_directory(fs::symlink_status(leftover, error))) fs::remove_all(leftover, error);
}

std::string withoutTrailingSlash(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path;
}

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
  if (!out_) throw core::IoError(final_path_ + ": cannot be written: " + std::strerror(errno));
}

void GrowingFile::append(std::string_view text) {
  out_.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!out_) throw core::IoError(final_path_ + ": writing failed: " + std::strerror(errno));
}

void GrowingFile::commit() {
  out_.close();
  if (!out_) throw core::IoError(final_path_ + ": writing failed: " + std::strerror(errno));
  file_.commit();
}

OutputLock::OutputLock(const std::string& output) : path_(withoutTrailingSlash(output) + ".lock") {
  while (true) {
    file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK, 0666);
    if (file_ < 0) throw core::IoError(path_ + ": cannot be made: " + std::strerror(errno));
    struct stat held {};
    struct stat named {};
    fstat(file_, &held);
    if (!S_ISREG(held.st_mode) || held.st_size > 0) {
      close(file_);
      throw core::InputError(path_ + ": is not a lock of ours; remove it, or choose another output");
    }
    if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
      const bool is_held = errno == EWOULDBLOCK;
      const std::string why = std::strerror(errno);
      close(file_);
      if (is_held) throw core::InputError(output + ": another run is writing it");
      throw core::IoError(path_ + ": cannot be locked: " + why);
    }
    // Whoever held it before may have removed it meanwhile.
    if (stat(path_.c_str(), &named) == 0 && named.st_ino == held.st_ino && named.st_dev == held.st_dev)
      return;
    close(file_);
  }
}

OutputLock::OutputLock(OutputLock&& other) noexcept
    : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)) {}

OutputLock::~OutputLock() {
  if (file_ < 0) return;
  unlink(path_.c_str());
  close(file_);
}

PendingFile::PendingFile(std::string final_path, bool keep_suffix)
    : final_path_(std::move(final_path)), temporary_path_(makeBeside(final_path_, keep_suffix)) {}

PendingFile::~PendingFile() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove(temporary_path_, ignored);
}

void PendingFile::commit() {
  std::error_code error;
  fs::rename(temporary_path_, final_path_, error);
  if (error) throw core::IoError(final_path_ + ": cannot be written: " + error.message());
  committed_ = true;
}

PendingFolder::PendingFolder(std::string final_path, bool overwrite)
    : final_path_(withoutTrailingSlash(std::move(final_path))), overwrite_(overwrite) {
  refuseToOverwrite(final_path_, overwrite_);
  std::error_code error;
  if (fs::exists(final_path_) && !fs::is_directory(final_path_))
    throw core::InputError(final_path_ + ": is a file, expected a folder");
  if (fs::exists(final_path_) && !fs::is_empty(final_path_) && !fs::exists(final_path_ + "/manifest.json"))
    throw core::InputError(
        final_path_ + ": holds other files and no manifest.json, so it is not replaced; remove it first");
  fs::create_directories(fs::absolute(final_path_).parent_path(), error);
  if (error) throw core::IoError(final_path_ + ": cannot be made: " + error.message());
  lock_.emplace(final_path_);
  removeLeftovers(final_path_);
  temporary_path_ = madeBeside(final_path_, "", [](const char* name) { return mkdir(name, 0777); });
}

PendingFolder::~PendingFolder() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove_all(temporary_path_, ignored);
}

void PendingFolder::commit() {
  std::error_code error;
  // What was there before is removed when the new one is in its place.
  const bool is_exchanged = overwrite_ && renameat2(AT_FDCWD, temporary_path_.c_str(), AT_FDCWD,
                                                    final_path_.c_str(), RENAME_EXCHANGE) == 0;
  if (is_exchanged) {
    fs::remove_all(temporary_path_, error);
    committed_ = true;
    return;
  }
  // It was not there, or this disk cannot exchange.
  if (overwrite_) fs::remove_all(final_path_, error);
  fs::rename(temporary_path_, final_path_, error);
  if (error) throw core::IoError(final_path_ + ": cannot be written: " + error.message());
  committed_ = true;
}

ScratchFolder::ScratchFolder() {
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  path_ = ((error ? fs::path("/tmp") : parent) / "rasterslam-XXXXXX").string();
  if (mkdtemp(path_.data()) == nullptr)
    throw core::IoError(path_ + ": this folder cannot be made: " + std::strerror(errno));
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
  requireReplaceable(path);
  if (!overwrite && fs::exists(path))
    throw core::InputError(path + ": exists; give --overwrite to replace it");
}

}  // namespace slam::files
