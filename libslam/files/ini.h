#pragma once
#include <map>
#include <string>
#include <vector>

namespace slam::files {

/// A configuration read from an .ini text and overridden key by key, that remembers where every value came
/// from.
///
/// Grammar: `[section]`, `key = value`, comments after `#` or `;` at the start of a line or after white
/// space, blank lines. Values are trimmed; nothing else is interpreted. A malformed line, a key before the
/// first section, or the same key twice in one section is an InputError with file and line.
class IniFile {
 public:
  struct Entry {
    std::string value;
    std::string origin;  ///< "configs/methods/icp.ini:12" or "--set"
  };

  IniFile() = default;
  /// Reads a text; `name` stands for the file in origins and errors.
  static IniFile parse(const std::string& text, const std::string& name);

  /// Overrides or adds one value.
  void set(const std::string& section, const std::string& key, const std::string& value,
           const std::string& origin);
  /// Takes "section.key=value" as the command line gives it. Anything else is an InputError.
  void setFromArgument(const std::string& argument, const std::string& origin);
  /// Every entry of `over` on top of this one.
  void overrideWith(const IniFile& over);

  /// nullptr when absent.
  const Entry* find(const std::string& section, const std::string& key) const;
  const std::map<std::string, std::map<std::string, Entry>>& sections() const { return sections_; }
  bool hasSection(const std::string& section) const { return sections_.count(section) != 0; }

 private:
  std::map<std::string, std::map<std::string, Entry>> sections_;
};

/// Without the blanks, tabs and line ends at both ends.
std::string trimmed(const std::string& text);

}  // namespace slam::files
