#include "libslam/mapping/method_types.h"

#include "libslam/core/error.h"
#include "libslam/methods/graph_method.h"
#include "libslam/methods/icp_method.h"
#include "libslam/methods/naive_method.h"
#include "libslam/methods/particle_method.h"
#include "libslam/methods/rbpf_method.h"

namespace slam::mapping {

const std::vector<methods::MethodType>& methodTypes() {
  static const std::vector<methods::MethodType> kTypes = {
      methods::naiveMethod(),     //
      methods::icpMethod(),       //
      methods::rbpfMethod(),      //
      methods::particleMethod(),  //
      methods::graphMethod(),     //
  };
  return kTypes;
}

const methods::MethodType& methodType(const std::string& name) {
  for (const auto& type : methodTypes())
    if (type.name == name) return type;
  throw core::ContractError("no type of method '" + name + "'");
}

std::string methodTypesWhich(const std::function<bool(const methods::MethodType&)>& is) {
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
