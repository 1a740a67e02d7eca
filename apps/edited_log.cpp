#include "apps/edited_log.h"

#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "apps/console.h"

namespace slam::apps {

void addEditedLog(CLI::App* command, Context& context, const std::string& what) {
  addOutput(command, context, what);
  command->get_option("--output")->required();
  addJson(command, context);
}

int reportEditedLog(const Context& context, const edit::EditCounts& counts,
                    const std::vector<std::string>& beside) {
  if (context.json) {
    std::cout << nlohmann::ordered_json{{"output", context.output},      {"read", counts.read},
                                        {"unchanged", counts.unchanged}, {"changed", counts.changed},
                                        {"composed", counts.composed},   {"dropped", counts.dropped},
                                        {"damage", counts.damage},       {"beside", beside}}
                     .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
              << "\n";
    return 0;
  }
  const auto n = [](std::uint64_t count) { return static_cast<unsigned long>(count); };
  std::printf("%lu objects: %lu as they were, %lu changed, %lu dropped\n", n(counts.read),
              n(counts.unchanged), n(counts.changed), n(counts.dropped));
  if (counts.composed > 0)
    std::printf("%lu actions took up the motion of dropped steps\n", n(counts.composed));
  if (!counts.damage.empty()) printWrapped("the log broke off: ", counts.damage);
  std::printf("  %s\n", context.output.c_str());
  for (const auto& file : beside) std::printf("  %s\n", file.c_str());
  return 0;
}

}  // namespace slam::apps
