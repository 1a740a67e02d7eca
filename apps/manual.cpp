#include <algorithm>
#include <cctype>
#include <sstream>

#include "apps/shell_words.h"
#include "libslam/files/files.h"
#include "libslam/resources/manifest.h"

namespace slam::apps {
namespace {

/// Text as roff prints it unchanged.
std::string roff(const std::string& text) {
  std::string result;
  bool begins_line = true;
  for (const char c : text) {
    if (begins_line && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
    begins_line = c == '\n';
  }
  return result;
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

std::vector<const CLI::App*> subcommands(const CLI::App& command) {
  return command.get_subcommands([](const CLI::App*) { return true; });
}

/// `rasterslam world make`
std::string lineOf(const CLI::App& command) {
  const auto* parent = command.get_parent();
  return parent == nullptr ? "rasterslam" : lineOf(*parent) + " " + command.get_name();
}

std::string pageOf(const CLI::App& command) {
  std::string page = lineOf(command);
  std::replace(page.begin(), page.end(), ' ', '-');
  return page;
}

void describeOptions(const CLI::App& command, bool positional, std::ostream& out) {
  for (const auto* option : command.get_options()) {
    if (option->get_positional() != positional || option->get_group().empty()) continue;
    const std::string name = positional ? option->get_single_name() : option->get_name(false, true);
    const bool takes_value = option->get_items_expected_max() > 0;
    out << ".TP\n.B " << roff(name);
    if (takes_value && !option->get_type_name().empty())
      out << " \\fI" << roff(option->get_type_name()) << "\\fR";
    out << "\n" << roff(option->get_description());
    if (!option->get_default_str().empty()) out << " (default: " << roff(option->get_default_str()) << ")";
    out << "\n";
  }
}

void describeArguments(const CLI::App& command, std::ostream& out) {
  for (const bool positional : {true, false}) {
    std::ostringstream rows;
    describeOptions(command, positional, rows);
    if (!rows.str().empty()) out << (positional ? ".SS Arguments\n" : ".SS Options\n") << rows.str();
  }
}

void describeCommands(const CLI::App& command, std::ostream& out) {
  for (const auto* below : subcommands(command)) {
    out << ".SH " << upper(lineOf(*below)) << "\n" << roff(below->get_description()) << "\n";
    describeArguments(*below, out);
    if (!below->get_footer().empty()) out << ".PP\n.nf\n" << roff(below->get_footer()) << "\n.fi\n";
    describeCommands(*below, out);
  }
}

std::string manualPage(const CLI::App& command) {
  std::ostringstream out;
  const bool whole = command.get_parent() == nullptr;
  const std::string meaning =
      whole ? "probabilistic 2D-lidar SLAM: simulate, map, score" : command.get_description();
  out << ".TH " << upper(pageOf(command)) << " 1 \"\" \"rasterslam " << resources::versionText()
      << "\" \"User Commands\"\n.ad l\n"
      << ".SH NAME\n"
      << roff(pageOf(command)) << " \\- " << roff(meaning) << "\n"
      << ".SH SYNOPSIS\n.B " << roff(lineOf(command)) << "\n"
      << (subcommands(command).empty() ? "" : "\\fICOMMAND\\fR ") << "[\\fIOPTIONS\\fR]";
  for (const auto* option : command.get_options())
    if (option->get_positional()) out << " \\fI" << roff(upper(option->get_single_name())) << "\\fR";
  out << "\n.SH DESCRIPTION\n" << roff(whole ? command.get_description() : meaning) << "\n";
  describeArguments(command, out);
  if (!command.get_footer().empty()) out << ".PP\n.nf\n" << roff(command.get_footer()) << "\n.fi\n";
  if (whole) {
    out << ".SH COMMANDS\n";
    for (const auto* below : subcommands(command))
      out << ".TP\n.BR " << roff(pageOf(*below)) << " (1)\n" << roff(below->get_description()) << "\n";
  } else {
    describeCommands(command, out);
    out << ".SH SEE ALSO\n.BR rasterslam (1)\n";
  }
  return out.str();
}

}  // namespace

void writeManual(const CLI::App& app, const std::string& folder) {
  files::writeFileAtomically(folder + "/rasterslam.1", manualPage(app));
  for (const auto* command : subcommands(app))
    files::writeFileAtomically(folder + "/" + pageOf(*command) + ".1", manualPage(*command));
}

}  // namespace slam::apps
