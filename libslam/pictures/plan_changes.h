#pragma once
#include <string>
#include <vector>

#include "libslam/check/plan_check.h"
#include "libslam/draw/canvas.h"
#include "libslam/world/plan.h"

namespace slam::pictures {

/// A plan before and after mending, at the same scale: beside each other where it is taller than wide, else
/// one above the other. Both show what changes in colour: on the left what goes, on the right what came; the
/// legend names only the changes that occur, with their cells. The picture's size, bytes and errors as in
/// picture.h. REQUIRES rasters and changes of one size (ContractError).
void drawPlanChanges(const world::Plan& before, const world::Plan& after,
                     const std::vector<check::Change>& changes, const std::string& title,
                     const std::string& file, const draw::Paper& paper = {});

}  // namespace slam::pictures
