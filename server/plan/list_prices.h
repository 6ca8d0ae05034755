// What one more light or object would cost in pictures of a scene, so that nobody adds more than there is time for.
#pragma once

#include "server/plan/work.h"
#include "server/sim/command.h"

namespace brume {

// Predicted for one picture `view`. `most_ms`: that it may take. What is added is as a new one, amid the medium.
ListPrices listPrices(PlanScene scene, const RenderSettings& settings, const PlanView& view, const CostModel& costs,
                      double most_ms);

} // namespace brume
