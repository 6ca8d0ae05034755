#include "server/options/groups.h"

namespace brume {

void addDeviceOptions(OptionTable& table, ServerOptions& o) {
    OptionGroup g(table, "Device");
    g.option("--device", o.device.name, "part of the Vulkan device's name; default: a GPU before a CPU driver");
    g.flag("--validation", o.device.validation, "run under the Vulkan validation layer");
    g.flag(
        "--no-mesh-shaders", [&o](bool none) { o.device.mesh_shaders = !none; },
        "use the vertex path even where mesh shaders exist");
    g.option("--costs", o.costs,
             "folder of the costs of this device: what a server learnt, or brume-bench calibrate measured");
    g.flag(
        "--fixed-costs", [&o](bool fixed) { o.frame.learn_costs = !fixed; },
        "the times of passes do not correct the costs, and nothing is written to their folder");
    g.option("--frame-budget", o.frame.frame_ms, "that a frame of all viewers may take before accuracy is given up")
        .range(1.0, 10'000.0)
        .unit("MS")
        .live();
    g.option("--refine-moving", o.frame.refine_moving,
             "part of it that finer pictures may take while cameras rest and the medium moves; 0: none")
        .range(0.0, 1.0);
    g.option("--measure-error", o.frame.measure_error,
             "part of one core that measures the error of pictures while they are sent; 0: nothing is measured")
        .range(0.0, 1.0);
    g.option(
         "--most-frame-time", o.frame.most_frame_ms,
         "that a frame of all viewers may take: larger pictures are made smaller, more lights and objects are refused")
        .range(1.0, 60'000.0)
        .unit("MS");
    g.option("--ahead", o.ahead, "compile shaders that may be needed later: background, off, or only that and end")
        .unit("HOW")
        .oneOf({"background", "off", "only"});
    g.flag("--explain", o.explain, "print what is rendered with, and why, for the scene's own camera, and end");
}

} // namespace brume
