#pragma once
#include "libslam/check/sheet.h"

namespace slam::check {

// One rule per file: each looks at the sheet as the rules before left it, adds what it finds to
// sheet.findings and paints the remedy.

void checkSize(Sheet& sheet);
void checkColours(Sheet& sheet);
void checkThresholds(Sheet& sheet);
void checkBorder(Sheet& sheet);
void checkScale(Sheet& sheet);
void checkText(Sheet& sheet);
void checkDimensions(Sheet& sheet);
void checkDoors(Sheet& sheet);
void checkLeaks(Sheet& sheet);
void checkOutside(Sheet& sheet);
void checkSpecks(Sheet& sheet);
void checkRays(Sheet& sheet);
void checkIsolated(Sheet& sheet);
void checkOpenEdge(Sheet& sheet);
void checkStart(Sheet& sheet);

}  // namespace slam::check
