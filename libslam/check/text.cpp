#include "libslam/check/rules.h"
#include "libslam/drafting/lettering.h"

namespace slam::check {

void checkText(Sheet& sheet) {
  if (sheet.is_map && !sheet.isAskedFor("text")) return;
  const drafting::Lettering lettering = drafting::findLettering(sheet.mask(world::Cell::kOccupied));
  if (lettering.words.empty()) return;
  Finding finding;
  finding.key = "text";
  finding.severity = Severity::kWarning;
  finding.count = static_cast<int>(lettering.words.size());
  int glyphs = 0;
  for (const drafting::Word& word : lettering.words) {
    glyphs += word.glyphs;
    finding.places.push_back(sheet.place(word.box.tl()));
  }
  finding.text = counted(finding.count, "word or figure", "words or figures") + " of " +
                 std::to_string(glyphs) + " letters, " + std::to_string(lettering.words.front().height) +
                 " pixels high, stand as walls (" + (finding.count >= 3 ? "quite sure" : "fairly sure") +
                 ")" + atPixel(finding.places);
  finding.remedy = "takes them away; what touches a wall stays";
  finding.is_mendable = true;
  sheet.paint(lettering.ink, world::Cell::kFree, Change::kRemoved);
  sheet.findings.push_back(finding);
}

}  // namespace slam::check
