#include "libslam/objects/sweep_note.h"

#include "libslam/core/error.h"
#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"

namespace slam::objects {
namespace {

constexpr const char* kSection = "sweep";

struct Fields {
  std::string label;
  double duration_s, stamped_share;
  bool clockwise;
};

const files::ParameterTable<Fields>& table() {
  static const files::ParameterTable<Fields> rows(
      kSection,
      {{"label", &Fields::label, "", {}, "sensor label of the lidar"},
       {"duration_s", &Fields::duration_s, 0.0, 0.0, 1e3, "from the first to the last beam"},
       {"clockwise", &Fields::clockwise, false, "the last beam is measured first"},
       {"stamped_share", &Fields::stamped_share, 1.0, 0.0, 1.0, "of the sweep that is over at the stamp"}});
  return rows;
}

}  // namespace

std::string formatSweepNote(const SweepNote& note) {
  return "[sweep]\nlabel = " + note.label + "\nduration_s = " + files::formatNumber(note.sweep.duration_s) +
         "\nclockwise = " + (note.sweep.clockwise ? "true" : "false") +
         "\nstamped_share = " + files::formatNumber(note.sweep.stamped_share) + "\n";
}

std::optional<SweepNote> parseSweepNote(const std::string& text) {
  if (text.rfind("[sweep]\n", 0) != 0) return std::nullopt;
  const auto ini = files::IniFile::parse(text, "sweep note");
  files::rejectUnknownSections(ini, {kSection});
  Fields fields;
  table().setDefaults(fields);
  files::readParameters(ini, table(), fields);
  for (const char* key : {"label", "duration_s"})
    if (!ini.find(kSection, key))
      throw core::InputError(std::string("sweep note: key '") + key + "' is missing");
  return SweepNote{fields.label, {fields.duration_s, fields.clockwise, fields.stamped_share}};
}

}  // namespace slam::objects
