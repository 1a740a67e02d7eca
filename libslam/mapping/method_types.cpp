#include "libslam/mapping/method_types.h"

#include "libslam/core/error.h"
#include "libslam/mapping/graph_method.h"
#include "libslam/mapping/icp_method.h"
#include "libslam/mapping/naive_method.h"
#include "libslam/mapping/particle_method.h"
#include "libslam/mapping/rbpf_method.h"

namespace slam::mapping {

const std::vector<MethodType>& methodTypes() {
  static const std::vector<MethodType> kTypes = {
      naiveMethod(),     //
      icpMethod(),       //
      rbpfMethod(),      //
      particleMethod(),  //
      graphMethod(),     //
  };
  return kTypes;
}

const MethodType& methodType(const std::string& name) {
  for (const auto& type : methodTypes())
    if (type.name == name) return type;
  throw core::ContractError("no type of method '" + name + "'");
}

std::string methodTypesWhich(const std::function<bool(const MethodType&)>& is) {
  std::vector<std::string> names;
  for (const auto& type : methodTypes())
    if (is(type)) names.push_back(type.name);
  std::string text;
  for (size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 < names.size() ? ", " : " or ";
    text += names[i];
  }
  return text;
}

}  // namespace slam::mapping
