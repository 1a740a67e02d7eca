#include "apps/show.h"

#include <cmath>
#include <exception>
#include <thread>

#include "apps/console.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"

namespace slam::apps {
namespace {

live::SnapshotMaker makerOf(const Show& what) {
  live::SnapshotMaker maker(what.title, what.method, what.T_scene_map);
  maker.setTruth(what.truth);
  maker.setLoops(what.loops);
  if (what.goal) maker.setGoal(*what.goal);
  if (what.strategic) maker.setStrategicView(what.strategic->stop_radius_m, what.strategic->directions_rad);
  return maker;
}

Shown takePicture(const Show& what, const ShowFlags& flags, const Loop& loop, viewer::LiveScene& scene) {
  auto maker = makerOf(what);
  live::MomentAt observer(maker, flags.at_s);
  try {
    loop(observer, nullptr);
  } catch (const core::Interrupted&) {
    if (!observer.moment()) throw;
  }
  if (!observer.moment())
    throw core::InputError("--at: found " + files::formatNumber(flags.at_s) + ", expected at most " +
                           files::formatNumber(maker.time_s()) + ", the time of the last scan");
  scene.show(*observer.moment(), {});
  files::writeFileAtomically(flags.screenshot,
                             viewer::renderPng(scene, viewer::cameraOver(scene.area(), scene.size())));
  return Shown::kPicture;
}

}  // namespace

Shown show(const Show& what, const ShowFlags& flags, const Loop& loop) {
  viewer::LiveScene scene(what.plan ? &*what.plan : nullptr, what.robot_side_m,
                          {flags.size[0], flags.size[1]});
  if (!flags.screenshot.empty()) return takePicture(what, flags, loop, scene);
  live::requireDisplay();
  live::Stage stage(live::Playback(flags.speed, flags.paused));
  auto maker = makerOf(what);
  live::StagedLoop observer(stage, maker, what.hands == live::Hands::kWatch);
  std::exception_ptr error;
  bool is_whole = false;
  std::thread worker([&] {
    try {
      loop(observer, &stage);
      is_whole = !stage.isClosed();
      stage.finish();
    } catch (const core::Interrupted&) {
      if (!stage.isClosed()) error = std::current_exception();
      stage.close();
    } catch (...) {
      error = std::current_exception();
      stage.close();
    }
  });
  try {
    live::WindowOptions window;
    window.title = what.title + " - rasterslam";
    window.hands = what.hands;
    window.close_at_end = flags.close;
    window.interrupted = interruptAsked;
    window.robot_radius_m = what.robot_side_m * std::sqrt(0.5);
    window.refusal = what.refusal;
    live::showWindow(stage, scene, window);
  } catch (...) {
    stage.close();
    worker.join();
    throw;
  }
  worker.join();
  if (error) std::rethrow_exception(error);
  if (interruptAsked() && what.hands == live::Hands::kWatch) throw core::Interrupted();
  return is_whole ? Shown::kWhole : Shown::kClosed;
}

}  // namespace slam::apps
