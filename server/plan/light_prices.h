// What one more point light would cost in pictures of a scene, so that nobody adds more than there is time for.
#pragma once

#include "server/plan/work.h"
#include "server/sim/command.h"

namespace brume {

// Predicted for one picture `view`. `most_ms`: that it may take. The light is as a new one, amid the medium.
LightPrices lightPrices(PlanScene scene, const RenderSettings& settings, const PlanView& view, const CostModel& costs,
                        double most_ms);

} // namespace brume
