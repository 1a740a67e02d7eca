#pragma once
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

namespace slam::files {

/// The whole file. Errors: missing, a directory, unreadable (InputError with the path).
std::string readTextFile(const std::string& path);

/// InputError unless path names an existing regular file that can be opened; one line says which it is not.
void requireReadableFile(const std::string& path);

/// Writes `path` so that it is either whole or not there: beside it first, then renamed (see PendingFile).
/// The folder must exist. Errors: IoError with the path and the reason.
void writeFileAtomically(const std::string& path, std::string_view content);

/// Nobody else of this program writes to an output while this lives. Held by a file of its own beside the
/// output, "NAME.lock", that is removed at the end; the lock itself dies with its process, whatever ends it.
/// Two of one process exclude each other, too. Errors: InputError when another holds it, or when NAME.lock is
/// somebody else's file; IoError.
class OutputLock {
 public:
  explicit OutputLock(const std::string& output);
  ~OutputLock();
  OutputLock(OutputLock&& other) noexcept;
  OutputLock& operator=(OutputLock&&) = delete;

 private:
  std::string path_;
  int file_ = -1;
};

/// A file being written beside its final name by code that wants a path (MRPT, OpenCV). commit() renames it;
/// without commit() the destructor removes it. It is made under a name that was not there before,
/// "NAME.rasterslam-MACHINE-PROCESS-XXXXXX", and no link is followed; files of such names that processes of
/// this machine left when they were killed are removed. keep_suffix: that name ends like the final one
/// ("map.rasterslam-....png"), for writers that choose the format by suffix. Errors: IoError; InputError when
/// the final name is a folder, a device or a pipe.
class PendingFile {
 public:
  explicit PendingFile(std::string final_path, bool keep_suffix = false);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  const std::string& path() const { return temporary_path_; }
  void commit();

 private:
  std::string final_path_, temporary_path_;
  bool committed_ = false;
};

/// A text file that grows while it is written: a PendingFile with its stream. Errors: IoError with the final
/// path, at the latest from commit().
class GrowingFile {
 public:
  explicit GrowingFile(const std::string& final_path);
  void append(std::string_view text);
  /// Everything to the disk, and the final name. Without it nothing is left.
  void commit();

 private:
  std::string final_path_;
  PendingFile file_;
  std::ofstream out_;
};

/// As PendingFile, for a folder: made empty beside the final name, renamed by commit(), removed otherwise;
/// locked meanwhile (OutputLock), and what a killed process of ours has left beside is cleaned up. An
/// existing final folder is replaced, in one step, at commit() only when `overwrite`, and only when it is
/// empty or holds a manifest.json (so it is a result of ours and not somebody's home); else the constructor
/// throws InputError. The final folder's parents are made if missing.
class PendingFolder {
 public:
  PendingFolder(std::string final_path, bool overwrite);
  ~PendingFolder();
  PendingFolder(const PendingFolder&) = delete;
  PendingFolder& operator=(const PendingFolder&) = delete;
  const std::string& path() const { return temporary_path_; }
  const std::string& finalPath() const { return final_path_; }
  void commit();

 private:
  std::string final_path_, temporary_path_;
  std::optional<OutputLock> lock_;
  bool overwrite_, committed_ = false;
};

/// An empty folder of a name that nobody else has, where the system keeps such things ($TMPDIR, else /tmp);
/// removed at the end with all in it. Errors: IoError with the path.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }
  /// path()/name
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

/// The file that the shell would start for the name of a program, by the PATH; "" where there is none.
std::string findProgram(const std::string& name);

/// InputError "… exists; give --overwrite to replace it" when path exists and overwrite is false, and when it
/// is neither a file nor a folder, which is never replaced.
void refuseToOverwrite(const std::string& path, bool overwrite);

}  // namespace slam::files
