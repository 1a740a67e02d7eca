#pragma once
#include <map>
#include <string>

namespace slam::process {

/// The files that a line of the shell names, each with the SHA-256 of its bytes: what stands where a command
/// does, found by the PATH, and any word, or its part behind a '=', that is the absolute path of a file,
/// unless it is written to (behind a '>'). Variables are not looked into, nor is what these files load or
/// start in their turn. Errors: IoError or InputError where one cannot be read.
std::map<std::string, std::string> filesOfCommand(const std::string& shell_line);

}  // namespace slam::process
