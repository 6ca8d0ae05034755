#include "server/plan/work.h"

#include <algorithm>
#include <cmath>

#include "server/inputs/eye_request.h"
#include "server/inputs/glass_block.h"
#include "server/medium/band_limit.h"
#include "server/methods/plans.h"
#include "server/opaque/objects.h"
#include "shaders/shared/support.h"

namespace brume {
namespace {

constexpr double kComputed = 0.25;        // of the pixels, where their neighbours tell most of them
constexpr double kPiecesWithoutSlabs = 6; // of a ray in a light's range

// View depths between which the medium lies before the eye, m.
struct Depths {
    double near, far;
};
Depths depthsOf(const MediumExtent& e, const Pose& pose) {
    const DepthRange all = depthRange(e, pose.position, pose.orientation * glm::vec3(0, 0, -1));
    Depths depths{all.near, all.far};
    depths.near = std::max(depths.near, double(kNearDepth));
    depths.far = std::max(depths.far, depths.near);
    return depths;
}

// m per m of view depth.
double pixelOf(const Frustum& frustum, uint32_t height) {
    return (double(frustum.up) + double(frustum.down)) / double(height);
}

// True: the ray eye + z ray meets the ball's shadow, a cylinder behind it, between the view depths of `range`.
bool meetsShadow(const PlanScene::Ball& ball, glm::dvec3 to_light, glm::dvec3 eye, glm::dvec3 ray, Depths range) {
    const glm::dvec3 from = eye - glm::dvec3(ball.centre);
    const double height = glm::dot(from, to_light), climb = glm::dot(ray, to_light);
    const glm::dvec3 across = from - height * to_light, over = ray - climb * to_light;
    const double a = glm::dot(over, over), b = glm::dot(across, over), r = double(ball.radius);
    const double square = b * b - a * (glm::dot(across, across) - r * r);
    if (square < 0 || a < 1e-12) return false;
    range.near = std::max(range.near, (-b - std::sqrt(square)) / a);
    range.far = std::min(range.far, (std::sqrt(square) - b) / a);
    // Behind: height + z climb <= 0.
    if (climb > 0) range.far = std::min(range.far, -height / climb);
    if (climb < 0) range.near = std::max(range.near, -height / climb);
    return range.near < range.far && (climb != 0 || height <= 0);
}

} // namespace

double PlanScene::support(const gpu::Particle& p) const {
    return double(physics::supportRadius(p.sigma_t, p.scale * tick.falloff, tick.cut));
}

Work& Work::operator+=(const Work& other) {
    for (size_t i = 0; i < units_.size(); ++i) units_[i] += other.units_[i];
    return *this;
}

Work& Work::operator*=(double times) {
    for (double& units : units_) units *= times;
    return *this;
}

double Work::ms(const CostModel& model) const {
    double ns = 0;
    for (size_t i = 0; i < allCosts().size(); ++i) ns += units_[i] * model.ns[i];
    return ns * 1e-6;
}

double cellsTouched(double lo, double hi, double size, double count) {
    const double first = std::clamp(std::floor(lo / size), 0.0, count),
                 last = std::clamp(std::floor(hi / size) + 1, 0.0, count);
    return std::max(last - first, 0.0);
}

double tetrahedraOnRay(uint32_t corners) { return 1 + 2 * std::cbrt(5.0 * corners); }

double groupsOf(uint32_t count, uint32_t size) { return std::ceil(double(count) / double(size)); }

Work sharedWork(const PlanScene& scene, const RenderSettings& settings) {
    Work work;
    work[costs::kUpload] = scene.particles;
    const auto dimmed = std::ranges::count_if(scene.local_lights, [](const auto& light) { return light.shadows != 0; });
    work[costs::kLocalLightDepth] = double(dimmed) * scene.particles;
    if (const gpu::Multiple& multiple = scene.tick.multiple; multiple.cells > 0) {
        const double cells =
            std::pow(multiple.cells, 3.0); // the next grids have 1/8 and 1/64, and 2 and 4 times the steps
        work[costs::kPropagation] =
            double(scene.hues) * multiple.channels * cells * settings.propagation.iterations * (1 + 2.0 / 8 + 4.0 / 64);
        // A part of a surface, whatever the channels, takes half as long as a step of a cell. Cells of the second grid,
        // an eighth, have them; of a box one and a half faces are seen and lit, by and large.
        const uint32_t planes = scene.tick.plane_count, bodies = scene.tick.opaque_count - planes;
        const double surfaces = (planes > 0 ? 1 : 0) + 1.5 * std::min(bodies, kMostReflecting);
        work[costs::kPropagation] +=
            0.5 * scene.hues * cells / 8 * std::pow(settings.propagation.surface_parts, 2.0) * surfaces;
    }
    planOf(settings.method)->addSharedWork(scene, settings, work);
    return work;
}

Work shadowWork(const PlanScene& scene, const PlanScene::Shadow& shadow) {
    Work work;
    const ShadowResolution& map = shadow.resolution;
    const glm::vec3 size = scene.tick.map.hi - scene.tick.map.lo;
    const glm::vec3 cell = size / glm::vec3(glm::vec2(map.texels), float(std::max(map.slices, 2u) - 1));
    if (scene.features.tetrahedra) {
        work[costs::kTetrahedraShadow] = double(map.texels.x) * map.texels.y * tetrahedraOnRay(scene.particles);
        return work;
    }
    double touched = 0;
    for (const gpu::Particle& p : scene.sample) {
        const double reach = 2 * scene.support(p);
        if (reach <= 0) continue;
        // In tiles of 8x8 texels and groups of planes: half a tile on either side besides.
        touched += std::min(reach / double(cell.x) + 8, double(map.texels.x)) *
                   std::min(reach / double(cell.y) + 8, double(map.texels.y)) *
                   std::min(reach / double(cell.z) + 6, double(map.slices));
    }
    work[costs::kShadowVolume] = touched * scene.weight() + 4.0 * map.texels.x * map.texels.y * map.slices;
    return work;
}

bool isInside(const MediumExtent& extent, glm::vec3 eye) {
    return glm::all(glm::lessThanEqual(extent.lo, eye)) && glm::all(glm::lessThanEqual(eye, extent.hi));
}

double projectedDeviation(const MediumExtent& extent, const PlanView& view) {
    const Depths depths = depthsOf(extent, view.pose);
    const double pixel = pixelOf(frustumOf(view.pose, view.width, view.height), view.height);
    return double(extent.deviation) / (pixel * 0.5 * (depths.near + depths.far));
}

ViewWork::ViewWork(const PlanScene& scene, const PlanView& view)
    : scene_(scene), view_(view), width_(view.width), height_(view.height) {
    const Frustum frustum = frustumOf(view.pose, view.width, view.height);
    pixel_ = pixelOf(frustum, view.height);
    layers_ = glassLayers(scene.glasses, view.pose, frustum);
    const glm::mat3 axes = glm::mat3_cast(view.pose.orientation);
    const auto inView = [&](glm::vec3 x) { // right, down, view depth
        const glm::vec3 d = x - view.pose.position;
        return glm::dvec3(double(glm::dot(d, axes[0])), -double(glm::dot(d, axes[1])), -double(glm::dot(d, axes[2])));
    };
    const Depths depths = depthsOf(scene.extent, view.pose);
    near_ = depths.near;
    far_ = depths.far;
    const glm::dvec2 axis = glm::dvec2(frustum.left, frustum.up) / pixel_; // where the view axis meets the picture
    const auto boxOf = [&](glm::vec3 centre, double radius) {
        const glm::dvec3 c = inView(centre);
        const double near = std::max(c.z - radius, double(kNearDepth)), far = c.z + radius;
        if (radius <= 0 || far <= near) return Seen{};
        const glm::dvec2 lo = glm::dvec2(c) - radius, hi = glm::dvec2(c) + radius;
        const glm::dvec2 first = glm::min(lo / near, lo / far) / pixel_ + axis;
        const glm::dvec2 last = glm::max(hi / near, hi / far) / pixel_ + axis;
        return Seen{std::max(first.x, 0.0),
                    std::min(last.x, double(width_)),
                    std::max(first.y, 0.0),
                    std::min(last.y, double(height_)),
                    near,
                    far};
    };
    for (const gpu::Particle& p : scene.sample)
        if (const Seen box = boxOf(p.centre, scene.support(p)); box.pixels() > 0) seen_.push_back(box);
    for (const gpu::LocalLight& light : scene.local_lights)
        lit_pixels_ += boxOf(light.bound, double(light.reach)).pixels();
}

const ShownMedium& ViewWork::shown() const {
    if (!shown_) shown_.emplace(scene_, view_);
    return *shown_;
}

Work ViewWork::of(const RenderSettings& settings) const {
    Work work;
    const MethodPlan& method = *planOf(settings.method);
    method.addViewWork(*this, settings, work);
    if (scene_.features.glass) addLayers(method.hasRays(), work);
    work *= scene_.hues;
    return work;
}

// Methods with rays make their field once, and it is looked up for each layer. Others draw the medium again: at most
// all of it, since a layer ends at its sheet.
void ViewWork::addLayers(bool has_rays, Work& work) const {
    Work layer = work;
    for (const CostInfo* cost : allCosts()) {
        const std::string_view pass = cost->pass;
        const bool of_field = pass == "compose" || pass == "shafts" || cost == &costs::kLocalLight,
                   once = pass == "opaque" || pass == "cull, sort" || pass == "compose";
        if (has_rays ? !of_field : once) layer[*cost] = 0;
    }
    layer *= layers_;
    work += layer;
    if (has_rays) work[costs::kCompose] += pixels(); // a field's picture
    if (layers_ > 0) work[costs::kGlass] += pixels() * (1 + layers_) * (1 + double(scene_.glasses.size()));
}

bool ViewWork::inside() const { return near_ <= double(kNearDepth); }

double ViewWork::raySpacing(uint32_t rate) const {
    return rate * pixel_ * 0.5 * (near_ + far_) / double(scene_.extent.deviation);
}

double ViewWork::slabThickness(uint32_t slabs) const {
    return (far_ - near_) / (slabs * double(scene_.extent.deviation));
}

double ViewWork::localPieces(const RenderSettings& settings) const {
    const bool particles = scene_.particles > 0;
    const bool coarse = pixelStep(settings.shading, settings.rate, particles) > 1;
    return lit_pixels_ * (coarse ? kComputed : 1) * (kPiecesWithoutSlabs + (particles ? settings.slabs : 0));
}

double ViewWork::shadowsMet() const {
    constexpr int kAcross = 8; // rays along each side of the picture
    if (scene_.caster_balls.empty()) return scene_.triangles;
    const Frustum frustum = frustumOf(view_.pose, width_, height_);
    const glm::dmat3 axes(glm::mat3_cast(view_.pose.orientation));
    const glm::dvec3 light(scene_.tick.sun.to_light), eye(view_.pose.position);
    const Depths medium = scene_.features.fog ? Depths{0, HUGE_VAL} : Depths{near_, far_};
    double met = 0;
    for (int i = 0; i < kAcross * kAcross; ++i) {
        const glm::dvec2 part = (glm::dvec2(i % kAcross, i / kAcross) + 0.5) / double(kAcross);
        const glm::dvec3 ray = axes * glm::dvec3(glm::mix(-double(frustum.left), double(frustum.right), part.x),
                                                 glm::mix(double(frustum.up), -double(frustum.down), part.y), -1);
        for (const PlanScene::Ball& ball : scene_.caster_balls)
            met += meetsShadow(ball, light, eye, ray, medium) ? 1 : 0;
    }
    return met * scene_.caster_weight / (kAcross * kAcross) + scene_.triangles;
}

double ViewWork::fragments(double part_of_box) const {
    double sum = 0;
    for (const Seen& s : seen_) sum += s.pixels();
    return sum * part_of_box * scene_.weight();
}

} // namespace brume
