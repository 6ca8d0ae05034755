#include "server/operate/own_frames.h"

#include <string_view>

#include "server/sim/state_hash.h"

namespace brume {

OwnFrames::OwnFrames(const gpu::Device& device, const Scene& scene, uint32_t capacity)
    : scene_(scene), renderer_(device, scene_, capacity), submission_(device, "own frame") {}

uint64_t OwnFrames::hash(const Simulation& simulation) {
    const PictureView picture = draw(simulation, ownView(scene_), false);
    StateHash hash;
    hash.add(std::string_view(reinterpret_cast<const char*>(picture.bytes), picture.layout.bytes()));
    return hash.value();
}

PictureView OwnFrames::picture(const Simulation& simulation, uint32_t width, uint32_t height) {
    PlanView view = ownView(scene_);
    view.width = width;
    view.height = height;
    return draw(simulation, view, true);
}

PictureView OwnFrames::draw(const Simulation& simulation, const PlanView& view, bool rests) {
    PlanInputs inputs;
    inputs.scene = planScene(scene_, simulation);
    inputs.views = {view};
    inputs.methods = allMethods();
    const RenderSettings planned = makePlan(inputs, builtInCosts()).chosen.settings,
                         settings = rests ? finer(planned) : planned;
    const EyeRequest eye{view.pose, view.width, view.height};
    renderer_.submit(submission_, simulation, {&eye, 1}, &settings, rests);
    while (!submission_.commands.wait(1'000'000'000)) {
    }
    return submission_.pictures().front();
}

} // namespace brume
