#pragma once
#include <string>

namespace slam::sweep {

/// Makes a folder and those above it. Errors: IoError with the path.
void makeFolder(const std::string& path);

/// partial/HOST.PID in a sweep's folder, locked (flock(2)) until this process ends, however it ends.
class Workplace {
 public:
  /// output: the sweep's folder. Errors: IoError with the path.
  explicit Workplace(const std::string& output);
  ~Workplace();
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  std::string path() const { return all_ + "/" + name_; }

  /// Removes what processes that are no more have left.
  void removeLeftovers() const;

  /// A file that every process in the sweep's folder would write alike: made here, then renamed.
  void publish(const std::string& name, const std::string& text, const std::string& output) const;

 private:
  std::string lockPath(const std::string& name) const { return all_ + "/" + name + ".lock"; }
  void lock();

  std::string all_, name_;
  int lock_ = -1;
};

}  // namespace slam::sweep
