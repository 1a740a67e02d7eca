#include "libslam/core/error.h"
#include "libslam/mrptnav/reactive_navigator.h"

namespace slam::mrptnav {

bool reactiveNavigationAvailable() {
  return false;
}

std::unique_ptr<goals::GoalNavigator> makeReactiveNavigator(const ReactiveOptions&,
                                                            const goals::NavigateOptions&,
                                                            const goals::GoalTask&) {
  throw core::InputError(
      "mrpt_reactive: this program was built without MRPT's module nav; install libmrpt-nav-dev and build "
      "again");
}

}  // namespace slam::mrptnav
