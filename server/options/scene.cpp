#include "server/options/groups.h"

namespace brume {

void addSceneOptions(OptionTable& table, ServerOptions& o) {
    OptionGroup g(table, "Scene");
    g.option("--scene", o.scene, "name of a scene, or the path of a .toml file").live();
    g.option("--scene-dir", o.scene_dir, "folder of the scenes known by name");
    g.option("--cloud-dir", o.cloud_dir, "folder of uploaded point clouds, the newest 16");
    g.several("--set", o.overrides, '\n', "a setting instead of the scene's, as in its file: --set medium.count=5000")
        .unit("KEY=VALUE")
        .standing("")
        .live();
    g.option("--method", o.method, "medium method instead of the scene's; auto: the cheapest within render.error");
    g.option("--quadrature", o.quadrature, "simpson | transmittance | analytic | taylor, for method isv");
    g.option("--steps", o.steps, "of the quadrature").range(limits::kSteps);
    g.option("--exposure", o.exposure, "factor before the tone map").range(limits::kExposure);
    g.option("--cutoff", o.cutoff, "bound on the optical depth that proxies leave out of any ray")
        .range(limits::kCutoff);
    g.option("--shadow-size", o.shadow_size, "texels a side of the volumetric shadow map; auto: as the medium needs")
        .rangeOrAuto(limits::kShadowSize);
    g.option("--shadow-slices", o.shadow_slices, "its planes; auto: as the medium needs")
        .rangeOrAuto(limits::kShadowSlices);
    g.option("--shadow-error", o.shadow_error, "relative error of the light that a map of such a size may make")
        .range(limits::kShadowError);
    g.flag(
         "--paused", [&o](bool paused) { o.paused = paused; },
         "start with the simulation paused, or not: instead of the scene's")
        .standing("the scene's");
}

} // namespace brume
