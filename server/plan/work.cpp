#include "server/plan/work.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/render/medium_grid.h"
#include "server/render/shading.h"
#include "shaders/shared/support.h"

namespace brume {
namespace {

constexpr double kMargin = 3, kBeyond = 2 * kMargin + 1; // nodes before a picture's first, and all beyond its cells
constexpr double kTile = 8;                              // rays, slabs and nodes that are worked on together, a side

double& at(Work& work, Cost cost) { return work[size_t(cost)]; }

// Cells of `size` that [lo, hi] touches, of `count` from 0.
double cells(double lo, double hi, double size, double count) {
    const double first = std::clamp(std::floor(lo / size), 0.0, count), last = std::clamp(std::floor(hi / size) + 1, 0.0, count);
    return std::max(last - first, 0.0);
}

double groups(uint32_t count, uint32_t size) { return std::ceil(double(count) / double(size)); }

double supportOf(const PlanScene& scene, const gpu::Particle& p) {
    return double(physics::supportRadius(p.sigma_t, p.scale * scene.tick.falloff, scene.tick.cut));
}

double weightOf(const PlanScene& scene) {
    return scene.sample.empty() ? 0 : double(scene.particles) / double(scene.sample.size());
}

// View depths between which the medium lies before the eye.
struct Depths {
    double near, far; // m
};
Depths depthsOf(const MediumExtent& e, const Pose& pose) {
    const DepthRange all = depthRange(e, pose.position, pose.orientation * glm::vec3(0, 0, -1));
    Depths depths{all.near, all.far};
    depths.near = std::max(depths.near, ViewWork::kNear);
    depths.far = std::max(depths.far, depths.near);
    return depths;
}

// m per m of view depth.
double pixelOf(const Frustum& frustum, uint32_t height) { return (double(frustum.up) + double(frustum.down)) / double(height); }

// Of the medium's grid.
void addGrid(const PlanScene& scene, const RenderSettings& settings, Work& work) {
    const gpu::MediumGrid grid = mediumGrid(scene.extent, settings);
    const glm::dvec3 bricks(grid.bricks);
    double reached = 0; // bricks
    for (const gpu::Particle& p : scene.sample) {
        const double reach = 2 * supportOf(scene, p) / double(grid.spacing) / kTile;
        if (reach <= 0) continue;
        reached += std::min(reach + 1, bricks.x) * std::min(reach + 1, bricks.y) * std::min(reach + 1, bricks.z);
    }
    const double kinds = scene.extent.one_albedo ? 1 : 4; // extinction, and what scatters each colour
    at(work, Cost::grid_bin) = scene.particles * (bricks.x + bricks.y + bricks.z);
    at(work, Cost::grid) = kinds * kTile * kTile * kTile * (reached * weightOf(scene) + 0.5 * bricks.x * bricks.y * bricks.z);
}

} // namespace

Work sharedWork(const PlanScene& scene, const RenderSettings& settings) {
    Work work{};
    at(work, Cost::upload) = scene.particles;
    if (settings.method == "tiles" && quadratureOf(settings) == "cached") at(work, Cost::particle_light) = scene.particles;
    if (scene.features.casters)
        at(work, Cost::opaque_shadow) = double(scene.wanted.opaque_shadow_size) * scene.wanted.opaque_shadow_size * scene.casters;
    if (settings.method == "grid") addGrid(scene, settings, work);
    return work;
}

Work shadowWork(const PlanScene& scene, const PlanScene::Shadow& shadow) {
    Work work{};
    const ShadowResolution& map = shadow.resolution;
    const glm::vec3 size = scene.tick.shadow_hi - scene.tick.shadow_lo;
    const glm::vec3 cell = size / glm::vec3(glm::vec2(map.texels), float(std::max(map.slices, 2u) - 1));
    double touched = 0;
    for (const gpu::Particle& p : scene.sample) {
        const double reach = 2 * supportOf(scene, p);
        if (reach <= 0) continue;
        // In tiles of 8x8 texels and groups of planes: half a tile on either side besides.
        touched += std::min(reach / double(cell.x) + 8, double(map.texels.x)) *
                   std::min(reach / double(cell.y) + 8, double(map.texels.y)) *
                   std::min(reach / double(cell.z) + 6, double(map.slices));
    }
    at(work, Cost::shadow_volume) = touched * weightOf(scene) + 4.0 * map.texels.x * map.texels.y * map.slices;
    return work;
}

double projectedDeviation(const MediumExtent& extent, const PlanView& view) {
    const Depths depths = depthsOf(extent, view.pose);
    const double pixel = pixelOf(frustumOf(view.pose, view.width, view.height), view.height);
    return double(extent.deviation) / (pixel * 0.5 * (depths.near + depths.far));
}

ViewWork::ViewWork(const PlanScene& scene, const PlanView& view)
    : scene_(scene), width_(view.width), height_(view.height), weight_(weightOf(scene)) {
    const Frustum frustum = frustumOf(view.pose, view.width, view.height);
    pixel_ = pixelOf(frustum, view.height);
    const glm::mat3 axes = glm::mat3_cast(view.pose.orientation);
    const auto inView = [&](glm::vec3 x) { // right, down, view depth
        const glm::vec3 d = x - view.pose.position;
        return glm::dvec3(double(glm::dot(d, axes[0])), -double(glm::dot(d, axes[1])), -double(glm::dot(d, axes[2])));
    };
    const Depths depths = depthsOf(scene.extent, view.pose);
    near_ = depths.near;
    far_ = depths.far;
    const glm::dvec2 axis = glm::dvec2(frustum.left, frustum.up) / pixel_; // where the view axis meets the picture
    for (const gpu::Particle& p : scene.sample) {
        const double radius = supportOf(scene, p);
        const glm::dvec3 c = inView(p.centre);
        const double near = std::max(c.z - radius, kNear), far = c.z + radius;
        if (radius <= 0 || far <= near) continue;
        const glm::dvec2 lo = glm::dvec2(c) - radius, hi = glm::dvec2(c) + radius;
        const glm::dvec2 first = glm::min(lo / near, lo / far) / pixel_ + axis;
        const glm::dvec2 last = glm::max(hi / near, hi / far) / pixel_ + axis;
        const Seen box{std::max(first.x, 0.0),
                       std::min(last.x, double(width_)),
                       std::max(first.y, 0.0),
                       std::min(last.y, double(height_)),
                       near,
                       far};
        if (box.right > box.left && box.bottom > box.top) seen_.push_back(box);
    }
}

double ViewWork::raySpacing(uint32_t rate) const {
    return rate * pixel_ * 0.5 * (near_ + far_) / double(scene_.extent.deviation);
}

double ViewWork::slabThickness(uint32_t slabs) const { return (far_ - near_) / (slabs * double(scene_.extent.deviation)); }

double ViewWork::deviationDepth() const { return scene_.extinction * double(scene_.extent.deviation); }

// Pixels of the particles' discs, `area` of the boxes around them.
double ViewWork::fragments(double area) const {
    double sum = 0;
    for (const Seen& s : seen_) sum += (s.right - s.left) * (s.bottom - s.top);
    return sum * area * weight_;
}

Work ViewWork::of(const RenderSettings& settings) const {
    Work work{};
    const double pixels = double(width_) * height_, particles = scene_.particles;
    const bool slabs = marches(settings); // which composes the sky and the field by itself
    if (!slabs || scene_.features.opaque) at(work, Cost::opaque) = pixels * (1 + scene_.objects);
    if (!slabs) {
        at(work, Cost::compose) = pixels;
        constexpr double kLeastSorted = 2000;                                       // the passes of the sort, with however few
        constexpr double kDisc = std::numbers::pi / 4, kTetrahedron = 0.37 * kDisc; // of the sphere around it, on average
        at(work, Cost::order) = particles + kLeastSorted;
        if (settings.method == "sphere") at(work, Cost::sphere) = fragments(kDisc);
        if (settings.method == "isv") at(work, Cost::isv) = fragments(kTetrahedron) * (1 + settings.steps);
        if (settings.method == "tiles") {
            at(work, Cost::tile_bin) = particles;
            at(work, Cost::tiles) = fragments(1) * (quadratureOf(settings) == "hermite" ? 2 : 1);
        }
        return work;
    }
    const double columns = groups(width_, settings.rate) + kBeyond, rows = groups(height_, settings.rate) + kBeyond;
    const double tiles_x = std::ceil(columns / kTile), tiles_y = std::ceil(rows / kTile), sheets = groups(settings.slabs, 8);
    const double kinds = scene_.extent.one_albedo ? 1 : 4; // extinction, and what scatters each colour
    const double lobe = scene_.features.lobe ? (1 - std::abs(double(scene_.tick.asymmetry))) / pixel_ : 1e30;
    const uint32_t step =
        scene_.features.opaque ? 1 : shadingStep(settings, settings.rate, float(1 / raySpacing(1)), float(lobe));
    if (step > 1) {
        at(work, Cost::shade) = (groups(width_, step) + 3) * (groups(height_, step) + 3);
        at(work, Cost::present) = pixels;
    } else {
        at(work, Cost::compose_field) = pixels * (1 + (scene_.features.opaque ? 2 : 0) + 2 * scene_.casters);
    }
    const double faces = scene_.features.opaque ? 1.4 : 1; // they are kept
    if (settings.method == "grid") {
        at(work, Cost::grid_rays) = columns * rows * settings.slabs * (isCubic(settings) ? 5 : 1) * kinds * faces;
        return work;
    }
    const double side = kTile * settings.rate, sheet = std::max((far_ - near_) / sheets, 1e-9);
    const double margin = kMargin * settings.rate; // pixels
    double reached = 0;
    for (const Seen& s : seen_)
        reached += cells(s.left + margin, s.right + margin, side, tiles_x) *
                   cells(s.top + margin, s.bottom + margin, side, tiles_y) * cells(s.near - near_, s.far - near_, sheet, sheets);
    at(work, Cost::slab_bin) = particles * (tiles_x + tiles_y + sheets);
    at(work, Cost::slabs) = kinds * kTile * kTile * kTile * (reached * weight_ + 0.5 * tiles_x * tiles_y * sheets);
    at(work, Cost::slab_light) = columns * rows * settings.slabs * faces;
    return work;
}

} // namespace brume
