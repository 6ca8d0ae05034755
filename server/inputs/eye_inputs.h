// What a pass may read for one eye, and the images that it draws into.
#pragma once

#include "common/camera.h"
#include "server/inputs/medium_view.h"
#include "server/inputs/tick_inputs.h"
#include "shaders/shared/types.h"

namespace brume {

// Images that all eyes use one after the other; they may be larger than the picture.
struct RenderTarget {
    gpu::Image radiance;   // RGBA32F: radiance, and transmittance of the medium in front of it
    gpu::Image view_depth; // R32F: m, of the nearest opaque surface

    // As images that are written, and as one that is sampled.
    void giveTo(gpu::Resources& resources, const gpu::Sampler& nearest) const {
        resources.give(gpu::storageImage("radiance", radiance));
        resources.give(gpu::storageImage("view_depth", view_depth));
        resources.give(gpu::sampledImage("view_depth", view_depth, nearest));
    }
};

// EyeInputs describes two pictures of one eye. size, step, pose and EyeBlock are of the drawn pixels; block and Views
// are of the finished picture, with step x step pixels for each drawn one.
struct EyeInputs {
    const TickInputs* shared = nullptr;
    const MediumView* medium = nullptr;
    const RenderTarget* target = nullptr;
    uint32_t view = 0; // the eye's number in the submission, for the names of passes
    VkExtent2D size{}; // pixels that are drawn
    uint32_t step = 1; // one pixel is drawn for step x step pixels of the finished picture
    uint32_t rate = 0; // pixels between rays, for methods that have rays. It is EyeRequest::rate, or where that is 0
                       // RenderSettings::rate; where both are 0, the medium's band limit decides
    Pose pose;
    const gpu::View* block = nullptr; // the finished picture: its eye, its rows and where its bytes go; on the CPU
    // EyeBlock, a gpu::Eye; Views, *block alone; radiance and view_depth of the target. OtherBlock is the gpu::Eye of
    // this head's other eye. It is this eye's own in mono, without shared_order, or if the two eyes see different
    // levels of detail. And MediumView::resources.
    gpu::Resources resources;
    uint64_t history = 0;        // EyeRequest::history
    uint32_t depth_layers = 0;   // EyeRequest::depth_layers
    bool near_plane_cuts = true; // True: the near plane may cut particles
    bool for_both_eyes = false;  // True: this eye's order is for both eyes of its head
    bool order_ready = false;    // True: DepthOrder holds this eye's order already, no sort is needed
    // True: a layer of the picture before, up to sheets of glass, is drawn. The method's last group had the same rays,
    // as long or longer.
    bool is_layer = false;
};

} // namespace brume
