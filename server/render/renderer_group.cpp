// Renderer: the passes of one group of views.
#include <algorithm>

#include "server/render/renderer.h"

namespace brume {

// One group in one hue. `before`: the eye whose surfaces the target has; null: none.
void Renderer::recordGroup(Submission& s, Method& method, const ViewGroup& group, const EyeInputs* before) {
    targets_.use(s.commands.handle(), *group.any->target);
    if (needsSurfaces(group, before)) {
        for (const auto& effect : effects_) effect->recordEye(s.commands, *group.any);
        surfaces_.record(s.commands, *group.any);
    }
    if (hasMedium() && drawsCoarsely()) recordCoarsely(s.commands, method, *group.any);
    if (hasMedium()) method.recordGroup(s.commands, group);
    recordFieldAndCompose(s.commands, group);
    ViewGroup drawn = group;
    if (features_.glass) {
        recordLayers(s.commands, method, group);
        drawn.field = nullptr; // the target has it all
        compose_.record(s.commands, drawn);
    }
    depth_layers_.record(s.commands, group);
    if (hasMedium() && !s.probe.pixels.empty()) probe_.record(s.commands, drawn, s.probe, views_[s.probe.eye]);
}

// Effects add their light to a field. Then pixels are composed, unless layers of glass are still to come.
void Renderer::recordFieldAndCompose(gpu::Commands& commands, const ViewGroup& group) {
    if (group.field)
        for (const auto& effect : effects_) effect->recordField(commands, group);
    if (group.field || !features_.glass) compose_.record(commands, group);
}

// Draws the medium again up to the sheets of glass, a layer at a time, and leaves the sum of all in the target.
void Renderer::recordLayers(gpu::Commands& commands, Method& method, const ViewGroup& group) {
    EyeInputs in = *group.any;
    in.order_ready = in.is_layer = true;
    ViewGroup layer = group;
    layer.any = &in;
    const auto splits = std::ranges::find_if(effects_, [&](const auto& effect) { return effect->layersOf(in) > 0; });
    if (splits == effects_.end()) return; // the target holds the picture
    Effect& effect = **splits;
    const uint32_t layers = effect.layersOf(in);
    for (uint32_t drawn = 0; drawn <= layers; ++drawn) {
        if (drawn > 0 && hasMedium() && !group.field) method.recordGroup(commands, layer);
        if (drawn > 0) recordFieldAndCompose(commands, layer);
        effect.recordLayer(commands, group, drawn, layers);
    }
}

// True if surfaces must be drawn into the target for this group. All bands of one picture share them. `before`: eye of
// the previous group.
bool Renderer::needsSurfaces(const ViewGroup& group, const EyeInputs* before) const {
    return group.any != before && (!group.field || features_.opaque);
}

// Draws the medium at every step-th pixel, and interpolates it to all pixels whose cell no edge crosses.
void Renderer::recordCoarsely(gpu::Commands& commands, Method& method, const EyeInputs& eye) {
    const EyeInputs& coarse = coarse_inputs_[eye.view];
    coarse_targets_.use(commands.handle(), *coarse.target);
    for (const auto& effect : effects_) effect->recordEye(commands, coarse);
    surfaces_.record(commands, coarse);
    cells_.clear(commands, coarse);
    method.recordGroup(commands, drawnAlone(coarse));
    cells_.interpolate(commands, eye, coarse);
    for (const auto& effect : effects_) effect->recordEye(commands, eye); // whose own are overwritten
}

} // namespace brume
