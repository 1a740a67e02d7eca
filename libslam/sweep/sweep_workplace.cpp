#include "libslam/sweep/sweep_workplace.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/files/files.h"

namespace slam::sweep {
namespace fs = std::filesystem;

void makeFolder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw core::IoError(path + ": cannot be made: " + error.message());
}

Workplace::Workplace(const std::string& output) : all_(output + "/partial") {
  makeFolder(all_);
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  name_ = std::string(host.data()) + "." + std::to_string(getpid());
  lock();
  fs::remove_all(path());
  makeFolder(path());
}
Workplace::~Workplace() {
  std::error_code ignored;
  fs::remove_all(path(), ignored);
  fs::remove(lockPath(name_), ignored);
  fs::remove(all_, ignored);  // when nobody else works
  close(lock_);
}
void Workplace::removeLeftovers() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(all_))
    if (entry.path().extension() != ".lock" && entry.path().filename() != name_)
      names.push_back(entry.path().filename().string());
    else if (entry.path().extension() == ".lock" && entry.path().stem() != name_)
      names.push_back(entry.path().stem().string());
  for (const auto& name : names) {
    const int file = open(lockPath(name).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0) continue;
    if (flock(file, LOCK_EX | LOCK_NB) == 0) {
      std::error_code ignored;
      fs::remove_all(all_ + "/" + name, ignored);
      fs::remove(lockPath(name), ignored);
    }
    close(file);
  }
}

void Workplace::lock() {
  while (true) {
    lock_ = open(lockPath(name_).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (lock_ < 0 || flock(lock_, LOCK_EX) != 0)
      throw core::IoError(lockPath(name_) + ": cannot be locked: " + std::strerror(errno));
    // Somebody who tidies up may have removed the file between the two calls.
    struct stat named {};
    struct stat held {};
    if (stat(lockPath(name_).c_str(), &named) == 0 && fstat(lock_, &held) == 0 && named.st_ino == held.st_ino)
      return;
    close(lock_);
  }
}

void Workplace::publish(const std::string& name, const std::string& text, const std::string& output) const {
  files::writeFileAtomically(path() + "/" + name, text);
  std::error_code error;
  fs::rename(path() + "/" + name, output + "/" + name, error);
  if (error) throw core::IoError(output + "/" + name + ": cannot be written: " + error.message());
}

}  // namespace slam::sweep
