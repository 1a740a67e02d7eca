#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace slam::resources {

/// A JSON file. What is no JSON is "discarded" (nlohmann::json). Errors: InputError for a file that cannot be
/// read, or whose values are nested more than 64 deep, on which much that walks through them would run out of
/// stack.
nlohmann::json readJsonFile(const std::string& path);

/// An object of a JSON file that people write: its keys, each asked for once; what is left over is unknown.
/// Errors are InputErrors that begin with `where` (file and place) and name the key.
class JsonEntry {
 public:
  /// Errors: not an object.
  JsonEntry(nlohmann::json json, std::string where);

  bool has(const std::string& key) const { return json_.contains(key); }
  // Each of these: errors when the key is missing or holds something else.
  std::string text(const std::string& key);
  double number(const std::string& key);
  double positiveNumberOrNull(const std::string& key);  ///< null: NaN
  std::vector<std::string> texts(const std::string& key);
  nlohmann::json take(const std::string& key);
  /// "WHERE: key 'KEY': found VALUE, expected EXPECTED".
  [[noreturn]] void fail(const std::string& key, const nlohmann::json& found,
                         const std::string& expected) const;
  void expectNothingElse() const;

 private:
  nlohmann::json json_;
  std::string where_;
};

}  // namespace slam::resources
