#pragma once
#include <functional>
#include <string>
#include <vector>

#include "libslam/methods/method_type.h"

namespace slam::mapping {

/// All of them. A new one has its line here (method_types.cpp), and nothing else of the library knows it.
const std::vector<methods::MethodType>& methodTypes();
/// REQUIRES the name of one (ContractError).
const methods::MethodType& methodType(const std::string& name);
/// "a, b or c" of those that it is true of.
std::string methodTypesWhich(const std::function<bool(const methods::MethodType&)>& is);

}  // namespace slam::mapping
