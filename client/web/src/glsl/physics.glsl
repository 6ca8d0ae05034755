// The server's formulas.
#include "../../../../shaders/shared/emission.h"
#include "../../../../shaders/shared/lit_particles.h"
#include "../../../../shaders/shared/multiple.h"
#include "../../../../shaders/shared/phase.h"
#include "../../../../shaders/shared/sky.h"
#include "../../../../shaders/shared/ground.h"
#include "../../../../shaders/shared/srgb.h"
