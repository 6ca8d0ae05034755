// Facts about a method that decide what the renderer and effects prepare for it.
#pragma once

namespace brume {

struct MethodNeeds {
    bool particle_light = false; // True: it reads light that is cached on particles, ParticleLights
    bool union_path = false;     // True: ParticleLights hold the sun's light behind the union of balls
    bool one_medium = false;     // True: it reads particles in recordTick() only, so all eyes see the same list of them
    // True: it writes RenderTarget::radiance, and may be given every 2nd, 4th or 8th pixel only. False: it makes a
    // field that Compose samples.
    bool writes_target = true;
    bool every_pixel = false; // True: it is given every pixel, whatever RenderSettings::rate says
};

} // namespace brume
