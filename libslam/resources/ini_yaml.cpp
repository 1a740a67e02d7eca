#include "libslam/resources/ini_yaml.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/resources/yaml_document.h"

namespace slam::resources {
namespace {

class YamlReader {
 public:
  YamlReader(const std::string& text, const std::string& name) : name_(name) {
    const YAML::Node root = yamlDocument(text, name);
    if (root.IsNull()) return;
    if (!root.IsMap()) throw wrong(root, "sections: a map of maps");
    for (const auto& section : root) {
      const auto title = plain(section.first, "a section's name");
      ini_.overrideWith(
          files::IniFile::parse("[" + title + "]", where(section.first.Mark())));  // also one without keys
      if (section.second.IsNull()) continue;
      if (!section.second.IsMap()) throw wrong(section.second, "keys and values in section '" + title + "'");
      for (const auto& entry : section.second) add(title, plain(entry.first, "a key"), entry);
    }
  }

  files::IniFile ini() const { return ini_; }

 private:
  using Entry = YAML::detail::iterator_value;

  std::string where(const YAML::Mark& mark) const { return yamlPlace(name_, mark); }

  core::InputError wrong(const YAML::Node& node, const std::string& expected) const {
    static const std::vector<std::string> kKinds = {"nothing", "nothing", "a value", "a list", "a map"};
    return core::InputError(where(node.Mark()) + ": found " + kKinds.at(static_cast<size_t>(node.Type())) +
                            ", expected " + expected);
  }

  /// What an .ini can hold.
  std::string plain(const YAML::Node& node, const std::string& what) const {
    if (!node.IsScalar()) throw wrong(node, what);
    auto text = files::trimmed(node.Scalar());
    const bool is_comment = !text.empty() && (text.front() == '#' || text.front() == ';');
    for (const char* no : {"\n", " #", " ;", "\t#", "\t;"})
      if (is_comment || text.find(no) != std::string::npos)
        throw core::InputError(where(node.Mark()) + ": found '" + text.substr(0, text.find('\n')) +
                               "', expected " + what + " without line breaks and comments");
    return text;
  }

  void add(const std::string& section, const std::string& key, const Entry& entry) {
    const auto origin = where(entry.first.Mark());
    const auto& node = entry.second;
    if (node.IsMap() && key.find('.') == std::string::npos) {
      for (const auto& inner : node) add(section, key + "." + plain(inner.first, "a key"), inner);
      return;
    }
    if (const auto* first = ini_.find(section, key))
      throw core::InputError(origin + ": section [" + section + "], key '" + key +
                             "' is given twice, first at " + first->origin);
    const auto what = "a value of key '" + key + "'";
    std::string value;
    if (node.IsSequence())
      for (const auto& item : node) {
        const auto word = plain(item, what);
        if (word.find(',') != std::string::npos)
          throw core::InputError(where(item.Mark()) + ": found '" + word + "', expected " + what +
                                 " without a comma");
        value += (value.empty() ? "" : ", ") + word;
      }
    else if (!node.IsNull())
      value = plain(node, what);
    ini_.set(section, key, value, origin);
  }

  std::string name_;
  files::IniFile ini_;
};

}  // namespace

bool isYamlFile(const std::string& path) {
  const auto extension = std::filesystem::path(path).extension();
  return extension == ".yaml" || extension == ".yml";
}

bool isConfigFile(const std::string& path) {
  return std::filesystem::path(path).extension() == ".ini" || isYamlFile(path);
}

files::IniFile parseYaml(const std::string& text, const std::string& name) {
  return YamlReader(text, name).ini();
}

files::IniFile readConfigFile(const std::string& path) {
  const auto text = files::readTextFile(path);
  return isYamlFile(path) ? parseYaml(text, path) : files::IniFile::parse(text, path);
}

}  // namespace slam::resources
