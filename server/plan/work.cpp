#include "server/plan/work.h"

#include <algorithm>
#include <cmath>

#include "server/effects/effect_plan.h"
#include "server/inputs/eye_request.h"
#include "server/inputs/objects.h"
#include "server/medium/band_limit.h"
#include "server/methods/plans.h"
#include "shaders/shared/support.h"

namespace brume {
namespace {

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
    planOf(settings.method)->addSharedWork(scene, settings, work);
    for (const EffectPlan* effect : effectPlans()) effect->addSharedWork(scene, settings, work);
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
        lit_pixels_ += lit_pixels_of_.emplace_back(boxOf(light.bound, double(light.reach)).pixels());
    if (seen_.empty()) return;
    Seen all = seen_.front();
    for (const Seen& one : seen_)
        all = {std::min(all.left, one.left),
               std::max(all.right, one.right),
               std::min(all.top, one.top),
               std::max(all.bottom, one.bottom),
               near_,
               far_};
    medium_pixels_ = all.pixels();
}

const SeenLight& ViewWork::light() const {
    if (!light_) light_.emplace(scene_, view_);
    return *light_;
}

Work ViewWork::of(const RenderSettings& settings) const {
    Work work;
    planOf(settings.method)->addViewWork(*this, settings, work);
    for (const EffectPlan* effect : effectPlans()) effect->addViewWork(*this, settings, work);
    work *= scene_.hues;
    return work;
}

bool ViewWork::inside() const { return near_ <= double(kNearDepth); }

double ViewWork::raySpacing(uint32_t rate) const {
    return rate * pixel_ * 0.5 * (near_ + far_) / double(scene_.extent.deviation);
}

double ViewWork::viewDepth(glm::vec3 x) const {
    return double(glm::dot(x - view_.pose.position, view_.pose.orientation * glm::vec3(0, 0, -1)));
}

double ViewWork::slabThickness(uint32_t slabs) const {
    return (far_ - near_) / (slabs * double(scene_.extent.deviation));
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
