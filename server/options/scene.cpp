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
    g.flag(
         "--paused", [&o](bool paused) { o.paused = paused; },
         "start with the simulation paused, or not: instead of the scene's")
        .standing("the scene's");
}

} // namespace brume
