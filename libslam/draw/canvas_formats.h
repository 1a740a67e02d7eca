#pragma once
#include <string>

#include "libslam/draw/canvas.h"

namespace slam::draw {

// What the writers of a canvas's formats share; for them alone.

/// As PNG, without loss.
std::string encodedPng(const drawing::Image& image);
/// The font of every picture.
inline constexpr char kFontName[] = "Liberation Sans";

}  // namespace slam::draw
