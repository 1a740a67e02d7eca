#pragma once

namespace slam::report {

/// What `npm run build` in page/ made: the page's script and style, as text without "</script" or "</style".
extern const char* const kPageScript;
extern const char* const kPageStyle;

}  // namespace slam::report
