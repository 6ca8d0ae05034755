#include "server/render/renderer.h"

#include <algorithm>

#include "common/phase_lobes.h"
#include "server/effects/effect_plan.h"
#include "server/inputs/eye_block.h"
#include "server/inputs/tick_block.h"

namespace brume {
namespace {

constexpr size_t kMostOfCells = 64; // objects

// True: particles of this layout live from the scene's start to its end.
bool staysTheSame(Layout layout) {
    return layout != Layout::emitter && layout != Layout::sequence && layout != Layout::live;
}

} // namespace

Renderer::Renderer(const gpu::Device& device, const Scene& scene, uint32_t capacity, const SceneFeatures& besides)
    : device_(device), scene_(scene), objects_(device, scene), meshes_(device, scene.triangles), besides_(besides),
      upload_(device, capacity), effects_(makeEffects({device, scene_, capacity})),
      surfaces_(device, objects_.counts(), !scene.triangles.empty()), depth_order_(device, capacity), compose_(device),
      probe_(device), cells_(device), depth_layers_(device), nearest_(device, VK_FILTER_NEAREST), targets_(device),
      coarse_targets_(device) {
    if (scene.tetrahedra) tetrahedra_.emplace(device, scene.tetrahedra);
    if (scene.volume) volume_.emplace(device, scene.volume, scene.medium.centre);
}

Renderer::~Renderer() = default;

// Takes the scene as it is now.
void Renderer::begin(const Simulation& simulation, const RenderSettings* settings) {
    countLightWork();
    now_ = simulation.now();
    tick_number_ = simulation.tick();
    if (settings) now_.render = *settings;
    if (lists_) leaveOut(now_, *lists_);
    features_ = besides_ | featuresOf(scene_, now_, lists_.value_or(SceneFeatures()));
    hues_ = huesOf(now_, simulation.liveCount());
    objects_.follow(scene_, now_.lists);
}

EffectInputs Renderer::effectInputs(const Simulation& simulation, std::span<const EyeRequest> eyes,
                                    const MethodNeeds& needs) {
    return {.simulation = simulation,
            .now = now_,
            .eyes = eyes,
            .objects = objects_.all(),
            .particles = upload_.list(),
            .extent = upload_.extent(),
            .needs = needs,
            .hues = uint32_t(hues_.size()),
            .moved = upload_.moved(),
            .all = upload_.all(),
            .seen = upload_.seenBy(eyes.size())};
}

// The frame, pass by pass.
void Renderer::submit(Submission& s, const Simulation& simulation, std::span<const EyeRequest> eyes,
                      const RenderSettings* settings, bool full) {
    begin(simulation, settings);
    Method& method = methodFor(now_.render);
    const MethodNeeds needs = method.needs();
    if (needs.one_medium || needs.union_path) now_.render.merge = 0;
    step_ = drawingStep(needs);
    drawn_.clear();
    for (const EyeRequest& eye : eyes) drawn_.push_back(everyStep(eye, step_));
    placePictures(s, eyes, full || hues_.size() > 1);
    probe_.prepare(s.probe);
    upload_.take(simulation, scene_, now_, objects_.all(), eyes, s.particles_);
    if (tetrahedra_ && upload_.moved()) tetrahedra_->follow(upload_.list());
    if (volume_) volume_->follow(scene_.medium.extinction > 0 ? now_.medium.extinction / scene_.medium.extinction : 1);
    surfaces_.prepare(eyes, objects_.counts(), objects_.all());
    gatherTick();
    const UniformBlocks blocks(s.uniforms_, eyes.size());
    upload_.writeBlocks(blocks, hues_, shared_.resources);
    upload_.all().volume = shared_.volume;
    EffectInputs in = effectInputs(simulation, eyes, needs);
    for (const auto& effect : effects_) effect->prepare(in, shared_);

    targets_.makeRoom(drawsCoarsely() ? eyes : drawn_);
    if (drawsCoarsely()) coarse_targets_.makeRoom(drawn_);
    const VkCommandBuffer cmd = s.commands.begin();
    upload_.record(s.commands, s.particles_);
    for (const auto& effect : effects_) effect->recordTick(s.commands, in, shared_);

    gatherEyes(blocks, eyes);
    s.uniforms_.flush();
    const std::span<const ViewGroup> groups = groupsOf(method);
    compose_.prepare(groups, eyes);
    takeLayers(s, groups, eyes);
    if (hasMedium()) method.recordTick(s.commands, shared_, *inputs_.front().medium);
    const EyeInputs* before = nullptr;
    for (const ViewGroup& group : groups) {
        for (uint32_t hue = 0; hue < hues_.size(); ++hue) {
            if (hues_.size() > 1) gpu::everythingBefore(cmd); // the hue before has used the same buffers and images
            shared_.later_hue = hue > 0;
            if (!before) {
                upload_.enter(blocks, hue);
                enterHue(hue);
                for (const auto& effect : effects_) effect->recordHue(s.commands, in, shared_);
            }
            recordGroup(s, method, group, before);
            if (hues_.size() > 1 && compose_.keepsRadiance()) keepHue(s.commands, group, hue);
        }
        if (hues_.size() == 1) before = group.any;
    }
    recordReadBack(s);
    s.commands.submit();
    upload_.submitted();
}

uint64_t Renderer::pictureBytes(std::span<const EyeRequest> eyes, bool full, const SceneFeatures& features) {
    uint64_t of_pixel = Targets::kBytesOfPixel;
    for (const EffectPlan* effect : effectPlans()) of_pixel += effect->bytesOfPixel(features);
    uint64_t planes = 0, target = 0;
    for (const EyeRequest& eye : eyes) {
        planes +=
            PlaneLayout{eye.width, eye.height, full}.bytes() + depthLayerBytes(eye.width, eye.height, eye.depth_layers);
        target = std::max(target, of_pixel * eye.width * eye.height);
    }
    return planes + target;
}

uint64_t Renderer::mostBytesOfPixel(const SceneFeatures& features) {
    uint64_t bytes = Targets::kBytesOfPixel * 5 / 4 + 8 / 4;
    for (const EffectPlan* effect : effectPlans()) bytes += effect->mostBytesOfPixel(features);
    return bytes;
}

uint64_t Renderer::pictureBytes() const {
    uint64_t bytes = targets_.bytes() + coarse_targets_.bytes() + planes_.size() + compose_.pictureBytes();
    for (const auto& effect : effects_) bytes += effect->pictureBytes();
    return bytes;
}

void Renderer::forget() {
    upload_.forget();
    for (const auto& effect : effects_) effect->forget();
}

void Renderer::giveBack() {
    countLightWork();
    methods_.clear();
    planes_ = {};
    compose_.giveBack();
    for (const auto& effect : effects_) effect->giveBack();
    targets_.giveBack();
    coarse_targets_.giveBack();
}

const LightWork& Renderer::countLightWork() {
    for (Made& made : methods_) light_work_ = light_work_ + made.method->workSince();
    return light_work_;
}

// The method compiled for these settings. The two methods used last are kept: switching between two costs nothing, and
// memory is bounded.
Method& Renderer::methodFor(const RenderSettings& settings) {
    const MethodPlan* plan = planOf(settings.method);
    const uint32_t variant = plan ? plan->variant(settings) : 0;
    const auto made = std::find_if(methods_.begin(), methods_.end(), [&](const Made& m) {
        return m.plan == plan && m.variant == variant && m.features == features_;
    });
    if (made != methods_.end()) {
        std::rotate(methods_.begin(), made, made + 1);
        return *methods_.front().method;
    }
    if (methods_.size() >= most_methods_) methods_.resize(most_methods_ - 1); // before the new one: memory is bounded
    auto method = makeMethod(
        {device_, depth_order_, settings, features_, scene_.medium.sprite_maps, staysTheSame(scene_.medium.layout)});
    methods_.insert(methods_.begin(), {plan, variant, features_, std::move(method)});
    return *methods_.front().method;
}

// The method draws every so many pixels: 1, 2, 4 or 8, the steps that present.comp is written for.
uint32_t Renderer::drawingStep(const MethodNeeds& needs) const {
    const uint32_t rate = now_.render.rate;
    // Between drawn pixels every object's shadow is looked for at each. Sheets of glass end rays in every pixel.
    if (!needs.writes_target || needs.every_pixel || features_.glass || rate < 2 ||
        objects_.all().size() > kMostOfCells)
        return 1;
    return rate >= 8 ? 8 : rate >= 4 ? 4 : 2;
}

// Makes room for the planes of all pictures, and sets where each picture's begin.
void Renderer::placePictures(Submission& s, std::span<const EyeRequest> eyes, bool full) {
    VkDeviceSize bytes = 0;
    s.pictures_.clear();
    for (const EyeRequest& eye : eyes) {
        s.pictures_.push_back({{eye.width, eye.height, full}, nullptr});
        bytes += s.pictures_.back().layout.bytes() + depthLayerBytes(eye.width, eye.height, eye.depth_layers);
    }
    if (bytes > mostPictureBytes(device_))
        throw gpu::Error("pictures of " + std::to_string(bytes >> 20) + " MiB together, the device allows " +
                         std::to_string(mostPictureBytes(device_) >> 20) + " MiB: ask for smaller ones");
    s.uniforms_.atLeast(device_, UniformBlocks::bytes(eyes.size(), hues_.size()),
                        VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::upload,
                        "uniforms");
    s.planes_.atLeast(device_, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback, "planes readback");
    planes_.atLeast(device_, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                    gpu::Memory::device, "planes");
    planes_bytes_ = bytes;
    VkDeviceSize at = 0;
    views_.assign(eyes.size(), {});
    for (size_t i = 0; i < eyes.size(); ++i) {
        PictureView& picture = s.pictures_[i];
        views_[i].planes = uint32_t(at / sizeof(uint32_t));
        views_[i].end = eyes[i].height;
        picture.bytes = s.planes_.mapped<uint8_t>(picture.layout.bytes(), at).data();
        at += picture.layout.bytes();
        DepthLayers::place(eyes[i], features_.opaque, at, views_[i].layers);
        at += depthLayerBytes(eyes[i].width, eyes[i].height, eyes[i].depth_layers);
    }
    compose_.fullColour(full);
    if (hues_.size() == 1 || !compose_.keepsRadiance()) return;
    kept_.resize(hues_.size());
    for (gpu::Buffer& kept : kept_)
        for (const EyeRequest& eye : drawsCoarsely() ? eyes : drawn_)
            kept.atLeast(device_, VkDeviceSize(eye.width) * eye.height * sizeof(glm::vec4),
                         VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback, "radiance of a hue");
}

// Where the layers of each eye's picture will be.
void Renderer::takeLayers(Submission& s, std::span<const ViewGroup> groups, std::span<const EyeRequest> eyes) const {
    s.layers_.assign(eyes.size(), {});
    for (size_t i = 0; i < eyes.size(); ++i) {
        if (eyes[i].depth_layers == 0) continue;
        const gpu::View* own = &views_[i];
        for (const ViewGroup& group : groups)
            for (const gpu::View& view : group.views)
                if (view.planes == own->planes && view.layers.count > 0) own = &view;
        s.layers_[i] = DepthLayers::viewOf(*own, s.planes_.mapped<uint8_t>(s.planes_.size()).data());
    }
}

// What all eyes share, but for what effects give.
void Renderer::gatherTick() {
    shared_ = {.settings = &now_.render,
               .number = tick_number_,
               .tick = &upload_.tick(),
               .objects_bounds = objects_.bounds(),
               .objects_version = objects_.version(),
               .reflecting_count = objects_.reflectingCount(),
               .bodies = objects_.counts().bodies(),
               .particles = &upload_.particles(),
               .nearest = &nearest_,
               .lobe_width = float(lobesOf(now_.medium).width()),
               .features = features_,
               .needs_rays = needsRays(upload_.tick()),
               .tetrahedra = tetrahedra_ ? &*tetrahedra_ : nullptr,
               .volume = volume_ ? &*volume_ : nullptr,
               .uses_target = features_.opaque || compose_.keepsRadiance()};
    shared_.objects_bounds.add(meshes_.bounds);
    for (const gpu::Resource& one :
         {gpu::storageBuffer("Objects", objects_.objects()), gpu::storageBuffer("ObjectNodes", objects_.nodes()),
          gpu::storageBuffer("Reflecting", objects_.reflecting()), gpu::storageBuffer("Triangles", meshes_.triangles),
          gpu::storageBuffer("MeshNodes", meshes_.nodes), gpu::storageBuffer("Planes", planes_)})
        shared_.resources.give(one);
}

void Renderer::gatherEyes(const UniformBlocks& blocks, std::span<const EyeRequest> eyes) {
    enterHue(0);
    inputs_.clear();
    for (uint32_t i = 0; i < eyes.size(); ++i) {
        const gpu::LightMap& map = upload_.tick().map;
        views_[i].eye = eyeBlock(eyes[i], now_.render);
        views_[i].map_rays = mapRays(views_[i].eye, map);
        blocks.setPicture(i, views_[i]);
        const gpu::Eye drawn = eyeBlock(drawn_[i], now_.render);
        blocks.setDrawn(i, {drawn, mapRays(drawn, map)});
        EyeInputs& in = inputs_.emplace_back();
        in = {.shared = &shared_,
              .medium = &upload_.of(i),
              .target = &targets_.of(drawsCoarsely() ? VkExtent2D{eyes[i].width, eyes[i].height}
                                                     : VkExtent2D{drawn_[i].width, drawn_[i].height}),
              .view = i,
              .size = {drawn_[i].width, drawn_[i].height},
              .step = step_,
              .rate = eyes[i].rate ? eyes[i].rate : now_.render.rate,
              .pose = drawn_[i].pose,
              .block = &views_[i],
              .history = eyes[i].history,
              .depth_layers = hues_.size() > 1 ? 0 : eyes[i].depth_layers, // a layer has one transmittance
              .near_plane_cuts = nearPlaneCuts(upload_.tick(), eyes[i])};
        in.resources = gpu::Resources(&in.medium->resources);
        in.resources.give(blocks.drawnEye(i));
        in.resources.give(blocks.drawnEye(i).as("OtherBlock"));
        in.resources.give(blocks.picture(i));
        in.target->giveTo(in.resources, nearest_);
        if (!eyes[i].second || !now_.render.shared_order || i == 0 || inputs_[i - 1].medium != in.medium) continue;
        inputs_[i - 1].resources.give(blocks.drawnEye(i).as("OtherBlock"));
        in.resources.give(blocks.drawnEye(i - 1).as("OtherBlock"));
        inputs_[i - 1].for_both_eyes = in.for_both_eyes = true;
        in.order_ready = true; // the left eye's sort covers both eyes
    }
    last_size_ = {eyes.back().width, eyes.back().height};
    if (!drawsCoarsely()) return;
    coarse_inputs_ = inputs_;
    for (uint32_t i = 0; i < eyes.size(); ++i) {
        coarse_inputs_[i].target = &coarse_targets_.of({drawn_[i].width, drawn_[i].height});
        coarse_inputs_[i].target->giveTo(coarse_inputs_[i].resources, nearest_);
        inputs_[i].size = {eyes[i].width, eyes[i].height};
        inputs_[i].step = 1;
        inputs_[i].resources.give(blocks.pictureEye(i));
        inputs_[i].order_ready = true; // the coarse picture has sorted the particles already
    }
}

// The groups of views that are drawn together; without a medium each eye is a group.
std::span<const ViewGroup> Renderer::groupsOf(Method& method) {
    if (hasMedium()) return method.prepare(inputs_);
    drawnOneByOne(inputs_, no_medium_);
    return no_medium_;
}

void Renderer::recordReadBack(Submission& s) {
    const gpu::Commands::Pass pass(s.commands, "read back");
    const VkCommandBuffer cmd = s.commands.handle();
    gpu::computeToTransfer(cmd);
    const VkBufferCopy copy{0, 0, planes_bytes_};
    vkCmdCopyBuffer(cmd, planes_.handle(), s.planes_.handle(), 1, &copy);
    gpu::transferToHost(cmd);
}

void Renderer::enterHue(uint32_t hue) {
    shared_.hue = hue;
    shared_.hue_parts[0] = hues_[hue].particles;
    std::ranges::copy(hues_[hue].fogs, shared_.hue_parts.begin() + 1);
}

// Keeps what the target holds of a group in one hue.
void Renderer::keepHue(gpu::Commands& commands, const ViewGroup& group, uint32_t hue) {
    const EyeInputs& in = *group.any;
    const Rows rows = group.field ? Rows{group.views.front().first, group.views.front().end} : Rows{0, in.size.height};
    gpu::everythingBefore(commands.handle());
    copyRows(commands.handle(), *in.target, in.size.width, rows, kept_[hue]);
}

// Of several hues the channels of each, and the mean transmittance.
std::vector<glm::vec4> Renderer::readDrawn(VkExtent2D size) {
    if (hues_.size() == 1) return readTarget(device_, targets_.of(size), size);
    std::vector<glm::vec4> all(size_t(size.width) * size.height, glm::vec4(0));
    for (size_t hue = 0; hue < hues_.size(); ++hue) {
        kept_[hue].invalidate();
        const std::span<const glm::vec4> pixels = kept_[hue].mapped<glm::vec4>(all.size());
        for (int c = 0; c < 3; ++c)
            if (hues_[hue].channels >> c & 1)
                for (size_t i = 0; i < all.size(); ++i) all[i][c] = pixels[i][c], all[i].a += pixels[i].a / 3;
    }
    return all;
}

std::vector<float> Renderer::readDepths() {
    if (!features_.opaque) return {};
    return brume::readDepths(device_, targets_.of(last_size_), last_size_);
}

std::vector<glm::vec4> Renderer::readRadiance() {
    if (step_ == 1 || features_.opaque) return readDrawn(last_size_);
    const VkExtent2D drawn{drawn_.back().width, drawn_.back().height};
    return interpolated(readDrawn(drawn), drawn.width, last_size_, step_);
}

} // namespace brume
