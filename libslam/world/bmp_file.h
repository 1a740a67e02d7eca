#pragma once
#include <opencv2/core.hpp>
#include <optional>

#include "libslam/world/picture_bytes.h"

namespace slam::world {

/// A BMP is the 14-byte file header, then a DIB header whose first field is its own size (Windows GDI,
/// BITMAPINFOHEADER, BITMAPV4HEADER, BITMAPV5HEADER). InputError unless the size is sensible and all pixels
/// are there.
void requireWholeBmp(const Bytes& file);

/// The pixels of a BMP of 32 bits a pixel, row 0 at the top: 8 bits blue, green, red, alpha (CV_8UC4).
/// nullopt for anything else, which general decoders read well; of these files they drop the alpha without a
/// word.
///
/// Alpha is what the mask for it says; where the header has no place for one (BITMAPINFOHEADER, which is what
/// System.Drawing writes for its 32-bit pictures) it is all bits that no colour takes. Most programs leave
/// those bits 0: alpha that is 0 everywhere means that there is none, and the picture is opaque (CV_8UC3). An
/// alpha below its maximum stays below 255. Top-down rows (a negative height) and masks of up to 32 adjoining
/// bits are read.
///
/// REQUIRES requireWholeBmp(). Errors (InputError with the path): a mask with holes or over another's bits,
/// pixels that begin within the header, a compression that 32 bits cannot have.
std::optional<cv::Mat> decodeBmp32(const Bytes& file);

}  // namespace slam::world
