// Facts about a method that decide what the renderer and effects prepare for it.
#pragma once

namespace brume {

struct MethodNeeds {
    bool particle_light = false; // True: it reads ParticleLights of MediumView::resources
    bool union_path = false;     // True: and that is light behind the union of balls
    bool one_medium = false;     // True: it reads particles in recordTick() only, so all eyes see the same list of them
    bool draws = true; // True: it writes RenderTarget::radiance, and may be given every 2nd, 4th or 8th pixel only.
                       // False: it makes a field that Compose samples
    bool every_pixel = false; // True: it is given every pixel, whatever RenderSettings::rate says
};

} // namespace brume
