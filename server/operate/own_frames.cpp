#include "server/operate/own_frames.h"

#include <string_view>

#include "server/sim/state_hash.h"

namespace brume {

OwnFrames::OwnFrames(const gpu::Device& device, const Scene& scene, uint32_t capacity)
    : scene_(scene), renderer_(device, scene_, capacity), submission_(device, "own frame") {}

uint64_t OwnFrames::hash(const Simulation& simulation) {
    const PlanView view = ownView(scene_);
    PlanInputs inputs;
    inputs.scene = planScene(scene_, simulation);
    inputs.views = {view};
    inputs.methods = allMethods();
    const RenderSettings settings = makePlan(inputs, builtInCosts()).chosen.settings;
    const EyeRequest eye{view.pose, view.width, view.height};
    renderer_.submit(submission_, simulation, {&eye, 1}, &settings);
    while (!submission_.commands.wait(1'000'000'000)) {
    }
    const PictureView picture = submission_.pictures().front();
    StateHash hash;
    hash.add(std::string_view(reinterpret_cast<const char*>(picture.bytes), picture.layout.bytes()));
    return hash.value();
}

} // namespace brume
