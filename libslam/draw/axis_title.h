#pragma once
#include <string>

namespace slam::draw {

/// A key as the title of an axis: "ATE final (m)" of ate_final_m.
std::string axisTitle(const std::string& key);

}  // namespace slam::draw
