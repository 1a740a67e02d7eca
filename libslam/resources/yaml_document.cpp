#include "libslam/resources/yaml_document.h"

#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/files/ini.h"

namespace slam::resources {
namespace {

/// Listens to a document for its end alone.
class Ignored : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
  }
  void OnMapEnd() override {}
};

/// Whether anything follows the first document. YAML::LoadAll() would not end where that is no document
/// either (",a").
bool goesOn(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  Ignored ignored;
  return parser.HandleNextDocument(ignored) && parser.HandleNextDocument(ignored);
}

}  // namespace

YAML::Node yamlDocument(const std::string& text, const std::string& name) {
  try {
    if (goesOn(text)) throw core::InputError(name + ": goes on behind its first document, expected one");
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    std::string reason = error.msg;  // may quote what it found
    std::replace_if(
        reason.begin(), reason.end(), [](unsigned char c) { return c < ' '; }, ' ');
    throw core::InputError(yamlPlace(name, error.mark) + ": is not YAML: " + files::trimmed(reason));
  }
}

std::string yamlPlace(const std::string& name, const YAML::Mark& mark) {
  return mark.is_null() ? name : name + ":" + std::to_string(mark.line + 1);
}

}  // namespace slam::resources
