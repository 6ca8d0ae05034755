// Converts linear radiance to displayed sRGB. Include after `eye` is declared.
#include "shaders/shared/srgb.h"

// Narkowicz's fit of the ACES reference curve: [0, inf) -> [0, 1].
vec3 filmic(vec3 x) { return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0, 1); }

// Displayed sRGB, 0 ... 255, of linear radiance.
vec3 displayed(vec3 radiance) {
    vec3 x = max(radiance * eye.exposure, 0);
    x = eye.filmic != 0 ? filmic(min(x, 1e4)) : clamp(x, 0, 1);
    return 255 * vec3(srgb(x.r), srgb(x.g), srgb(x.b));
}
