#include "server/render/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "server/light/tick.h"

namespace brume {

namespace {

constexpr float kNearDepth = 0.05f; // m
// Offset of a uniform block; 256 is the largest alignment that Vulkan lets a device ask for.
constexpr VkDeviceSize kBlockBytes = 256;
static_assert(sizeof(gpu::Tick) <= kBlockBytes && sizeof(gpu::View) <= kBlockBytes);

constexpr VkDeviceSize eyeOffset(uint32_t eye) { return (eye + 1) * kBlockBytes; } // ticks of merged media come behind all eyes

gpu::Eye eyeBlock(const EyeRequest& request, const gpu::Tick& tick, const RenderSettings& settings) {
    const glm::mat3 axes = glm::mat3_cast(glm::normalize(request.pose.orientation));
    gpu::Eye eye{};
    eye.position = request.pose.position;
    eye.near_depth = kNearDepth;
    eye.right = axes[0];
    eye.up = axes[1];
    eye.back = axes[2];
    const Frustum frustum = frustumOf(request.pose, request.width, request.height);
    eye.tan_x = 0.5f * (frustum.left + frustum.right);
    eye.tan_y = 0.5f * (frustum.up + frustum.down);
    eye.exposure = settings.exposure;
    eye.size = {request.width, request.height};
    eye.filmic = settings.tone_map == "filmic";
    eye.ray_right = eye.right * (2 * eye.tan_x / float(request.width));
    eye.ray_down = eye.up * (-2 * eye.tan_y / float(request.height));
    eye.ray = -eye.back - frustum.left * eye.right + frustum.up * eye.up;
    const auto inVolume = [&](glm::vec3 x, float w) {
        const glm::vec4 h(x, w);
        return glm::vec3(glm::dot(tick.shadow_u, h), glm::dot(tick.shadow_v, h), glm::dot(tick.shadow_plane, h));
    };
    eye.volume = inVolume(eye.position, 1);
    eye.volume_ray = inVolume(eye.ray, 0);
    eye.volume_right = inVolume(eye.ray_right, 0);
    eye.volume_down = inVolume(eye.ray_down, 0);
    return eye;
}

// The same view, drawn at every `step`-th of its pixels, from a step before its first (shaders/lib/shaded.glsl).
EyeRequest everyStep(const EyeRequest& eye, uint32_t step) {
    if (step == 1) return eye;
    const Frustum f = frustumOf(eye.pose, eye.width, eye.height);
    const float pixel = (f.left + f.right) / float(eye.width), before = (1.5f * float(step) - 0.5f) * pixel;
    EyeRequest coarse{eye.pose, gpu::groups(eye.width, step) + 3, gpu::groups(eye.height, step) + 3, eye.second};
    const float wide = float(coarse.width * step) * pixel, high = float(coarse.height * step) * pixel;
    coarse.pose.frustum = {f.left + before, wide - f.left - before, f.up + before, high - f.up - before};
    return coarse;
}

// Weights of the values at -1, 0, 1, 2: shaders/present.comp.
glm::vec4 cubic(float t) {
    return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2, (t + 1) * t * (t - 1) / 6};
}

// Makes `buffer` hold at least `bytes`; what it held is lost.
void grow(gpu::Buffer& buffer, const gpu::Device& device, VkDeviceSize bytes, VkBufferUsageFlags usage, gpu::Memory memory,
          const char* name) {
    if (buffer && buffer.size() >= bytes) return;
    buffer = gpu::Buffer(device, std::max<VkDeviceSize>(bytes, 256), usage, memory, name);
}

bool sameBits(std::span<const gpu::Particle> a, std::span<const gpu::Particle> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

// True unless the eye is so far from the medium's bounds (light space) that its near plane meets no particle.
bool eyeInMedium(const gpu::Tick& tick, const EyeRequest& eye) {
    const glm::vec3 x = eye.pose.position;
    const glm::vec3 at(glm::dot(tick.light_x, x), glm::dot(tick.light_y, x), glm::dot(tick.to_light, x));
    const glm::vec3 outside = glm::max(glm::max(tick.shadow_lo - at, at - tick.shadow_hi), glm::vec3(0));
    return glm::length(outside) < 2 * kNearDepth * cornerLength(frustumOf(eye.pose, eye.width, eye.height));
}

} // namespace

SceneFeatures featuresOf(const Scene& scene) {
    SceneFeatures features;
    features.opaque = !scene.planes.empty() || !scene.boxes.empty() || !scene.spheres.empty();
    features.casters = !scene.boxes.empty() || !scene.spheres.empty();
    features.ambient = scene.sky.ambient != glm::vec3(0);
    return features;
}

std::span<const PictureView> Submission::pictures() {
    planes_.invalidate();
    return pictures_;
}

Renderer::Renderer(const gpu::Device& device, const Scene& scene, uint32_t capacity, const SceneFeatures& besides)
    : device_(device), scene_(scene), capacity_(capacity), objects_(opaqueObjects(scene)), shadow_volume_(device, capacity),
      opaque_shadow_(device), particle_light_(device, capacity), background_(device, scene), depth_order_(device, capacity),
      features_(featuresOf(scene) | besides), compose_(device, features_), cells_(device), linear_(device, VK_FILTER_LINEAR),
      nearest_(device, VK_FILTER_NEAREST) {
    particles_ =
        gpu::Buffer(device, std::max(capacity, 1u) * sizeof(gpu::Particle),
                    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::device, "particles");
    objects_buffer_ =
        gpu::Buffer(device, gpu::kMostObjects * sizeof(gpu::Opaque),
                    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, gpu::Memory::upload, "objects");
    std::copy(objects_.begin(), objects_.end(), objects_buffer_.mapped<gpu::Opaque>(objects_.size()).begin());
    objects_buffer_.flush();
}

Renderer::~Renderer() = default;

void Renderer::fitBuffers(Submission& s, const Simulation& simulation, std::span<const EyeRequest> eyes, bool full) {
    VkDeviceSize planes = 0;
    s.pictures_.clear();
    for (const EyeRequest& eye : eyes) {
        s.pictures_.push_back({{eye.width, eye.height, full}, nullptr});
        planes += s.pictures_.back().layout.bytes();
    }
    grow(s.uniforms_, device_, eyeOffset(uint32_t(3 * eyes.size())),
         VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::upload, "uniforms");
    grow(s.planes_, device_, planes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback, "planes readback");
    grow(planes_, device_, planes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Memory::device,
         "planes");
    VkDeviceSize at = 0;
    views_.assign(eyes.size(), {});
    for (size_t i = 0; i < eyes.size(); ++i) {
        PictureView& picture = s.pictures_[i];
        views_[i].planes = uint32_t(at / sizeof(uint32_t));
        views_[i].end = eyes[i].height;
        picture.bytes = s.planes_.mapped<uint8_t>(picture.layout.bytes(), at).data();
        at += picture.layout.bytes();
    }
    particles_now_.resize(simulation.liveCount());
    simulation.write(particles_now_);
    const std::span<const gpu::Particle> particles = particles_now_;
    moved_ = !sameBits(particles, particles_then_);
    const gpu::Tick then = tick_;
    tick_ = makeTick(scene_, now_, particles, objects_);
    if (moved_ || tick_.falloff != then.falloff || tick_.cut != then.cut) {
        ++particle_version_;
        extent_ = mediumExtent(particles, tick_.falloff, tick_.cut);
    }
    fitParticles(s, particles, eyes);
    s.uniforms_.mapped<gpu::Tick>(1)[0] = tick_;
    for (uint32_t i = 0; i < eyes.size(); ++i) {
        views_[i].eye = eyeBlock(eyes[i], tick_, now_.render);
        s.uniforms_.mapped<gpu::View>(1, eyeOffset(i))[0] = views_[i];
        s.uniforms_.mapped<gpu::Eye>(1, eyeOffset(uint32_t(2 * eyes.size()) + i))[0] = eyeBlock(drawn_[i], tick_, now_.render);
    }
    s.uniforms_.flush();
}

// What is new of the particles, as the device gets them: in the order of space where they are many, and merged for eyes far away.
void Renderer::fitParticles(Submission& s, std::span<const gpu::Particle> particles, std::span<const EyeRequest> eyes) {
    std::span<const gpu::Particle> ordered = particles;
    if (particles.size() >= kLargeMedium) {
        ordered_.resize(particles.size());
        if (moved_) order_.sort(particles, ordered_);
        ordered = ordered_;
    }
    merged_.choose(ordered, moved_, tick_, extent_, eyes, now_.render.merge);
    const VkDeviceSize bytes = capacity_ * sizeof(gpu::Particle);
    grow(s.particles_, device_, bytes + merged_.uploadBytes(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Memory::upload,
         "particle upload");
    if (moved_) std::copy(ordered.begin(), ordered.end(), s.particles_.mapped<gpu::Particle>(ordered.size()).begin());
    merged_.write(device_, s.particles_, bytes);
    s.particles_.flush();
    auto block = uint32_t(eyes.size());
    for (MergedMedia::Medium* medium : merged_.media()) {
        s.uniforms_.mapped<gpu::Tick>(1, eyeOffset(block))[0] = medium->tick;
        medium->tick_block = gpu::uniformBuffer(0, s.uniforms_, eyeOffset(block++), sizeof(gpu::Tick));
    }
}

void Renderer::fitTargets(VkCommandBuffer cmd, Targets& targets, std::span<const EyeRequest> eyes) const {
    VkExtent2D extent = targets.radiance ? targets.radiance.extent() : VkExtent2D{1, 1};
    for (const EyeRequest& eye : eyes) extent = {std::max(extent.width, eye.width), std::max(extent.height, eye.height)};
    const VkExtent2D has = targets.radiance ? targets.radiance.extent() : VkExtent2D{};
    if (extent.width == has.width && extent.height == has.height) return;
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    const VkImageUsageFlags copied = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    targets.radiance = gpu::Image(device_, {kRadianceFormat, extent, usage | copied}, "radiance");
    targets.view_depth = gpu::Image(device_, {VK_FORMAT_R32_SFLOAT, extent, usage}, "view depth");
    gpu::toGeneral(cmd, targets.radiance);
    gpu::toGeneral(cmd, targets.view_depth);
}

Method& Renderer::method(const SceneNow& now) {
    SceneFeatures features = features_;
    features.lobe = features.lobe || now.medium.anisotropy > 0;
    const std::string key =
        now.render.method + ' ' + now.render.quadrature + ' ' + std::to_string(now.render.steps) + (features.lobe ? " lobe" : "");
    std::unique_ptr<Method>& made = methods_[key];
    if (!made) made = makeMethod({device_, depth_order_, now.render, features});
    return *made;
}

void Renderer::submit(Submission& s, const Simulation& simulation, std::span<const EyeRequest> eyes,
                      const RenderSettings* settings, bool full) {
    now_ = simulation.now();
    if (settings) now_.render = *settings;
    Method& chosen = method(now_);
    if (chosen.sharesMedium()) now_.render.merge = 0; // one medium for all eyes
    step_ = drawingStep(chosen);
    drawn_.clear();
    for (const EyeRequest& eye : eyes) drawn_.push_back(everyStep(eye, step_));
    fitBuffers(s, simulation, eyes, full);
    compose_.fullColour(full);

    const VkCommandBuffer cmd = s.commands.begin();
    fitTargets(cmd, targets_, drawsCells() ? eyes : drawn_);
    if (drawsCells()) fitTargets(cmd, node_targets_, drawn_);
    if ((moved_ || merged_.uploadBytes() > 0) && tick_.particle_count > 0) {
        const gpu::Commands::Pass pass(s.commands, "upload");
        gpu::everythingBefore(cmd);
        const VkBufferCopy copy{0, 0, tick_.particle_count * sizeof(gpu::Particle)};
        if (moved_) vkCmdCopyBuffer(cmd, s.particles_.handle(), particles_.handle(), 1, &copy);
        merged_.record(cmd, s.particles_, capacity_ * sizeof(gpu::Particle));
        gpu::transferToCompute(cmd);
    }
    const gpu::Resource tick_block = gpu::uniformBuffer(0, s.uniforms_, 0, sizeof(gpu::Tick));
    opaque_shadow_.record(s.commands, tick_block, tick_, objects_buffer_, objects_);
    if (shadow_volume_.record(s.commands, tick_block, tick_, particles_, !moved_)) {
        particle_light_.invalidate();
        merged_.invalidateLight();
    }
    if (chosen.readsParticleLight()) recordParticleLight(s, tick_block);

    gatherInputs(s, now_, eyes);
    chosen.prepare(inputs_);
    for (const gpu::View& view : views_)
        if (step_ > 1 && !features_.opaque) compose_.fit(Compose::shadedWords(view, step_));
    if (tick_.particle_count > 0) chosen.recordShared(s.commands, inputs_.front());
    chosen.record(s.commands, inputs_);
    {
        const gpu::Commands::Pass pass(s.commands, "read back");
        gpu::computeToTransfer(cmd);
        const VkBufferCopy copy{0, 0, views_.back().planes * sizeof(uint32_t) + s.pictures_.back().layout.bytes()};
        vkCmdCopyBuffer(cmd, planes_.handle(), s.planes_.handle(), 1, &copy);
        gpu::transferToHost(cmd);
    }
    s.commands.submit();
    std::swap(particles_now_, particles_then_);
}

// For every list of particles that some eye sees.
void Renderer::recordParticleLight(Submission& s, const gpu::Resource& tick_block) {
    const auto record = [&](ParticleLight& light, const gpu::Resource& tick, const gpu::Buffer& particles, uint32_t count) {
        light.record(s.commands, {tick, &objects_buffer_, &particles, &shadow_volume_.image(), &linear_}, count,
                     now_.render.light_tolerance);
    };
    bool unmerged = false;
    for (size_t i = 0; i < s.pictures_.size(); ++i) unmerged = unmerged || !merged_.of(i);
    if (unmerged) record(particle_light_, tick_block, particles_, tick_.particle_count);
    for (MergedMedia::Medium* medium : merged_.media()) {
        if (!medium->light) medium->light = std::make_unique<ParticleLight>(device_, capacity_);
        record(*medium->light, medium->tick_block, medium->particles, medium->tick.particle_count);
    }
}

void Renderer::gatherInputs(Submission& s, const SceneNow& now, std::span<const EyeRequest> eyes) {
    inputs_.clear();
    for (const EyeRequest& eye : eyes) {
        EyeInputs& in = inputs_.emplace_back();
        in.view = uint32_t(inputs_.size() - 1);
        const EyeRequest& drawn = drawn_[in.view];
        in.size = {drawn.width, drawn.height};
        in.step = step_;
        in.particle_count = tick_.particle_count;
        in.eye_in_medium = eyeInMedium(tick_, eye);
        in.tick = gpu::uniformBuffer(0, s.uniforms_, 0, sizeof(gpu::Tick));
        in.eye = gpu::uniformBuffer(1, s.uniforms_, eyeOffset(uint32_t(2 * eyes.size()) + in.view), sizeof(gpu::Eye));
        in.block = &views_[in.view];
        in.view_block = gpu::storageBuffer(1, s.uniforms_, eyeOffset(in.view), sizeof(gpu::View));
        in.particle_version = particle_version_;
        in.particles = &particles_;
        in.objects = &objects_buffer_;
        in.first_caster = uint32_t(scene_.planes.size());
        in.particle_light = &particle_light_.buffer();
        in.shadow_volume = &shadow_volume_.image();
        in.opaque_shadow = &opaque_shadow_.image();
        in.view_depth = &targets_.view_depth;
        in.radiance = &targets_.radiance;
        in.extent = &extent_;
        in.settings = &now.render;
        in.rate = eye.rate ? eye.rate : now.render.rate;
        if (const MergedMedia::Medium* medium = merged_.of(in.view)) {
            in.particle_count = medium->tick.particle_count;
            in.tick = medium->tick_block;
            in.particles = &medium->particles;
            in.particle_light = medium->light ? &medium->light->buffer() : nullptr;
            in.extent = &medium->extent;
        }
        in.pose = drawn.pose;
        in.lobe = features_.lobe || now.medium.anisotropy > 0;
        in.asymmetry = now.medium.asymmetry;
        in.planes = &planes_;
        in.background = &background_;
        in.compose = &compose_;
        in.linear = &linear_;
        in.nearest = &nearest_;
        last_size_ = {eye.width, eye.height};
        in.other = in.eye;
        in.other.binding = 6;
        if (!eye.second || !now.render.shared_order || in.view == 0 || inputs_[in.view - 1].particles != in.particles) continue;
        EyeInputs& first = inputs_[in.view - 1];
        std::swap(first.other, in.other);
        in.ordered = true;
    }
    if (!drawsCells()) return;
    nodes_ = inputs_;
    for (EyeInputs& in : inputs_) {
        EyeInputs& nodes = nodes_[in.view];
        nodes.radiance = &node_targets_.radiance;
        nodes.view_depth = &node_targets_.view_depth;
        in.size = {eyes[in.view].width, eyes[in.view].height};
        in.step = 1;
        in.eye = gpu::uniformBuffer(1, s.uniforms_, eyeOffset(in.view), sizeof(gpu::Eye));
        in.ordered = true; // its nodes have been
        in.nodes = &nodes;
        in.cells = &cells_;
    }
}

uint64_t Renderer::particleBytes() const {
    return (particles_now_.capacity() + particles_then_.capacity() + ordered_.capacity()) * sizeof(gpu::Particle) +
           order_.bytes() + merged_.cpuBytes();
}

// A power of two: what present.comp knows.
uint32_t Renderer::drawingStep(const Method& method) const {
    const uint32_t rate = now_.render.rate;
    if (!method.draws() || rate < 2) return 1;
    return rate >= 8 ? 8 : rate >= 4 ? 4 : 2;
}

std::vector<glm::vec4> Renderer::readRadiance() {
    const bool every = step_ == 1 || features_.opaque; // pixel is there
    const VkExtent2D drawn = every ? last_size_ : VkExtent2D{drawn_.back().width, drawn_.back().height};
    const size_t count = size_t(drawn.width) * drawn.height;
    gpu::Buffer pixels(device_, count * sizeof(glm::vec4), VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback,
                       "radiance readback");
    gpu::Commands commands(device_, "read radiance");
    const VkCommandBuffer cmd = commands.begin();
    gpu::everythingBefore(cmd);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageExtent = {drawn.width, drawn.height, 1};
    vkCmdCopyImageToBuffer(cmd, targets_.radiance.handle(), VK_IMAGE_LAYOUT_GENERAL, pixels.handle(), 1, &copy);
    gpu::transferToHost(cmd);
    commands.submit();
    commands.wait(~0ull);
    pixels.invalidate();
    const std::span<glm::vec4> mapped = pixels.mapped<glm::vec4>(count);
    if (every) return {mapped.begin(), mapped.end()};
    std::vector<glm::vec4> all;
    for (uint32_t y = 0; y < last_size_.height; ++y)
        for (uint32_t x = 0; x < last_size_.width; ++x) {
            const glm::vec4 across = cubic(float(x % step_) / float(step_)), down = cubic(float(y % step_) / float(step_));
            glm::vec4& sum = all.emplace_back(0);
            for (uint32_t j = 0; j < 4; ++j)
                for (uint32_t i = 0; i < 4; ++i)
                    sum += across[int(i)] * down[int(j)] * mapped[size_t(y / step_ + j) * drawn.width + x / step_ + i];
        }
    return all;
}

} // namespace brume
