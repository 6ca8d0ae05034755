#include "tools/bench/pictures.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "server/plan/planner.h"
#include "server/sim/state_hash.h"
#include "tools/bench/stage.h"

namespace brume::bench {
namespace {

constexpr glm::uvec2 kSize{192, 108};
constexpr uint32_t kTicks = 12; // simulated first, so that media have moved

// Renders one scene by one method and adds a line for each picture.
class Fingerprint {
public:
    Fingerprint(const gpu::Device& device, const Case& wanted, std::string method)
        : method_(std::move(method)), scene_(sceneOf(wanted)), simulation_(scene_),
          renderer_(device, scene_, simulation_.capacity()), submission_(device, "pictures") {
        for (uint32_t i = 0; i < kTicks; ++i) simulation_.step({});
    }

    std::string lines(const std::string& camera) {
        const Pose pose = poseOf(camera, scene_, simulation_);
        const EyeRequest one{pose, kSize.x, kSize.y};
        RenderSettings settings = settingsFor(one);
        const std::string start = fmt::format("{} {} {}", scene_.name, camera, method_);
        std::string out = fmt::format("{} plain {:016x}\n", start, planes({&one, 1}, settings));
        out += fmt::format("{} full-colour {:016x}\n", start, planes({&one, 1}, settings, true));
        out += fmt::format("{} batch {:016x}\n", start, planes(headAndOthers(pose), settings));
        renderer_.keepRadiance(true);
        out += fmt::format("{} radiance {:016x}\n", start, radiance(one, settings));
        renderer_.keepRadiance(false);
        settings.rate = 4;
        out += fmt::format("{} every-4th {:016x}\n", start, planes({&one, 1}, settings));
        std::fputs(out.c_str(), stderr);
        return out;
    }

private:
    RenderSettings settingsFor(const EyeRequest& eye) const {
        PlanInputs inputs{.scene = planScene(scene_, simulation_), .methods = allMethods()};
        inputs.views = {{eye.pose, eye.width, eye.height}};
        const Plan plan = makePlan(inputs, builtInCosts());
        return scene_.render.method == kAutoMethod ? plan.chosen.settings : scene_.render;
    }

    // Two eyes of a head, a small viewer from the other side, one whose rays are farther apart.
    std::vector<EyeRequest> headAndOthers(Pose pose) const {
        pose.eye_separation = 0.064f;
        const Pose behind = turnedAbout(pose, scene_.camera.target, 2.5f);
        return {{eyePose(pose, 0, 2), 128, 72},
                {eyePose(pose, 1, 2), 128, 72, true},
                {behind, 96, 54},
                {eyePose(pose, 0, 1), 160, 90, false, 8}};
    }

    void submit(std::span<const EyeRequest> eyes, const RenderSettings& settings, bool full) {
        renderer_.submit(submission_, simulation_, eyes, &settings, full);
        while (!submission_.commands.wait(1'000'000'000)) {
        }
    }
    uint64_t planes(std::span<const EyeRequest> eyes, const RenderSettings& settings, bool full = false) {
        submit(eyes, settings, full);
        StateHash hash;
        for (const PictureView& picture : submission_.pictures())
            hash.add(std::string_view(reinterpret_cast<const char*>(picture.bytes), picture.layout.bytes()));
        return hash.value();
    }
    uint64_t radiance(const EyeRequest& eye, const RenderSettings& settings) {
        submit({&eye, 1}, settings, false);
        const std::vector<glm::vec4> pixels = renderer_.readRadiance();
        StateHash hash;
        hash.add(std::span(&pixels[0].x, 4 * pixels.size()));
        return hash.value();
    }

    const std::string method_;
    const Scene scene_;
    Simulation simulation_;
    Renderer renderer_;
    Submission submission_;
};

// Names of the shipped scenes, then the paths of what they lack: several albedos, and ellipsoids.
std::vector<std::string> scenes() {
    std::vector<std::string> names = sceneNames(BRUME_SCENES);
    for (const char* lacked : {"/albedos.toml", "/ellipsoids.toml"})
        names.emplace_back(BRUME_BENCH_SCENES + std::string(lacked));
    return names;
}

} // namespace

std::string pictureHashes(const gpu::Device& device, const std::string& only) {
    std::string out;
    for (const std::string& scene : scenes()) {
        if (std::filesystem::path(scene).stem().string().find(only) == only.npos) continue;
        const Scene loaded = loadScene(findScene(scene, BRUME_SCENES));
        std::vector<std::string> all_methods = methodNames({.balls = loaded.medium.model == kUnionMedium,
                                                            .tetrahedra = loaded.medium.model == kTetrahedraMedium,
                                                            .ellipsoids = loaded.medium.model == kEllipsoidMedium});
        all_methods.emplace_back(kAutoMethod);
        std::sort(all_methods.begin(), all_methods.end());
        const SceneFeatures extras{.meshes = !loaded.triangles.empty(),
                                   .fog = !loaded.fogs.empty(),
                                   .local_lights = !localLightsOf(loaded).empty()};
        for (const std::string& method : all_methods) {
            if (planOf(method) && !extrasRefusal(*planOf(method), extras).empty()) continue;
            Fingerprint fingerprint(device, {.scene = scene, .set = {"render.method=" + method}}, method);
            for (const char* camera : {"outside", "inside"}) out += fingerprint.lines(camera);
        }
    }
    return out;
}

} // namespace brume::bench
