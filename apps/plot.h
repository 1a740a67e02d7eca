#pragma once
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/commands.h"
#include "libslam/draw/canvas.h"

namespace slam::apps {

/// How large a picture will be, as the command line has it.
struct PaperArguments {
  std::string width, font = "8pt";
  double dpi = 300;
};

/// -o, --overwrite, --json, --width, --font, --dpi: what every kind of picture takes.
std::shared_ptr<PaperArguments> addPicture(CLI::App* command, Context& context,
                                           const std::string& default_name);

/// Where the picture goes and its size; refused before any work is done. A PNG is for the screen unless a
/// width is given, the others are as wide as a page. Errors: InputError for an extension, a length, or a file
/// that exists.
struct PicturePlace {
  std::string file;
  draw::Paper paper;
};
PicturePlace picturePlace(const Context& context, const PaperArguments& arguments,
                          const std::string& default_name);

/// The facts as JSON, or the line.
void sayPicture(const Context& context, const nlohmann::ordered_json& facts, const std::string& line);

// An operation log replayed: path, and the naive map's dots where the scans are at hand.
void addPlotOperations(CLI::App& plot, Context& context);
// Figures of what other commands wrote: map, paths, errors, cost, seeds, stress, exploration.
void addPlotResults(CLI::App& plot, Context& context);

}  // namespace slam::apps
