#pragma once
#include <string>
#include <vector>

#include "libslam/resources/data_folder.h"

namespace slam::learn {

/// A kind of thing that a folder can be begun for, as configs/templates/templates.ini has it.
struct TemplateKind {
  std::string name;                    ///< "method"
  std::string meaning;                 ///< one line
  std::vector<std::string> languages;  ///< the first is the usual one
};
/// In the order of their names. Errors: InputError for a broken templates.ini.
std::vector<TemplateKind> templateKinds();

/// What to begin.
struct TemplateRequest {
  std::string kind, language;  ///< language "": the usual one
  std::string
      name;  ///< small letters, digits and _, a letter first; of the folder, the class, the row in tables
  std::string output;   ///< folder; "": the name
  std::string library;  ///< where the library is found: see libraryFolder()
};

struct MadeFolder {
  std::string path;
  std::vector<std::string> files;  ///< in it, sorted
  std::vector<std::string> next;   ///< shell lines to be given where the folder lies
};

/// Writes a folder to begin from: the files of configs/templates/KIND/LANGUAGE and shared/LANGUAGE, the name
/// put in. It builds, runs and passes its own test as it is. It appears whole or not at all, and what is
/// there is never replaced: it may hold somebody's work. Errors: InputError for an unknown kind or language,
/// a name that is none, is reserved or one of the built-in ones, an output that exists.
MadeFolder makeFromTemplate(const TemplateRequest& request);

/// Where a project finds the library that came with a program: the build folder of a program that lies in it,
/// else the prefix that it is installed under.
std::string libraryFolder(const resources::DataPlaces& places);

/// "wall_hugger" -> "WallHugger".
std::string className(const std::string& name);

}  // namespace slam::learn
