#include "server/operate/upload.h"

#include <fmt/format.h>

#include "common/scene_limits.h"
#include "common/scene_text.h"
#include "common/volume/volume.h"
#include "server/sim/point_cloud.h"

namespace brume {
namespace {

constexpr const char* kVolumeEnding = ".nrrd";

// More points are merged to balls, and balls can be drawn by all.
const char* modelOf(const std::string& bytes, const std::string& name, const PlyContents& contents, size_t count) {
    if (contents.tetrahedra) return kTetrahedraMedium;
    const bool ellipsoids = contents.axes && double(count) <= limits::kCount.hi && hasEllipsoids(bytes, name);
    return ellipsoids ? kEllipsoidMedium : kSumMedium;
}

} // namespace

std::string endingOf(const std::string& bytes) { return isNrrd(bytes) ? kVolumeEnding : ".ply"; }

UploadedScene sceneOfUpload(const std::string& bytes, const UploadOptions& options, const std::filesystem::path& file) {
    const std::string name = file.stem().string() + endingOf(bytes);
    const bool volume = name.ends_with(kVolumeEnding);
    const PlyContents contents = volume ? PlyContents() : contentsOf(bytes, name);
    const PlyExtent extent = volume ? volumeExtentOf(bytes, name, options.up) : extentOf(bytes, name, options.up);
    UploadFrame frame(extent, options);
    std::string keys =
        fmt::format("origin = [{:.1f}, {:.1f}, {:.1f}]\n[medium]\nfile = \"{}\"\nunit = {}\nup = \"{}\"\n",
                    frame.origin.x, frame.origin.y, frame.origin.z, name, frame.unit, options.up);
    keys += volume ? "layout = \"volume\"\n"
                   : fmt::format("layout = \"file\"\nmodel = \"{}\"\nfar_points = \"{}\"\n",
                                 modelOf(bytes, name, contents, extent.count), options.keep_far ? "keep" : "drop");
    UploadedScene out{sceneOf(keys, file, {}), std::move(frame.notes)};
    Scene& scene = out.scene;
    placeCamera(scene);
    // Half of what an even sky sends from above on the average of all directions: nothing shadows ambient light.
    scene.sky.ambient = 0.125f * (scene.sky.zenith + scene.sky.horizon);
    if (contents.splats) { // their colours hold the light already
        scene.lights.clear();
        scene.sky.ambient = glm::vec3(1);
        scene.render.tone_map = "linear";
        out.notes.emplace_back("the splats are shown in ambient light alone; light.irradiance adds a sun");
    }
    return out;
}

} // namespace brume
