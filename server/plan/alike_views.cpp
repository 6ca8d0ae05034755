#include "server/plan/alike_views.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace brume {
namespace {

enum class Place { away, outside, inside }; // away: the medium is not in the picture

struct Seen {
    Place place;
    double deviation; // pixels
    const PlanView* view;
};

// Of the ball around the medium, against the cone around the picture.
Place placeOf(const MediumExtent& extent, const PlanView& view) {
    if (isInside(extent, view.pose.position)) return Place::inside;
    const Frustum frustum = frustumOf(view.pose, view.width, view.height);
    const float across = std::max(std::abs(frustum.left), std::abs(frustum.right)),
                along = std::max(std::abs(frustum.up), std::abs(frustum.down));
    const double corner = std::atan(std::hypot(double(across), double(along)));
    const glm::vec3 to_middle = 0.5f * (extent.lo + extent.hi) - view.pose.position;
    const double distance = double(glm::length(to_middle)), radius = 0.5 * double(glm::distance(extent.lo, extent.hi));
    if (distance <= radius) return Place::outside;
    const glm::vec3 forward = -glm::mat3_cast(view.pose.orientation)[2];
    const double angle = std::acos(std::clamp(double(glm::dot(forward, to_middle)) / distance, -1.0, 1.0));
    return angle - std::asin(radius / distance) < corner ? Place::outside : Place::away;
}

double pixelsOf(const PlanView& view) { return double(view.width) * view.height; }

// One for these, which are not empty.
PlanView standIn(std::span<const Seen> group, const Corrections& corrections) {
    const auto hardness = [&](const Seen& seen) {
        return std::tuple(corrections.largest(seen.view->viewer), seen.deviation);
    };
    PlanView one = *std::ranges::max_element(group, {}, hardness)->view;
    double pixels = 0;
    for (const Seen& seen : group) pixels += pixelsOf(*seen.view);
    one.weight = pixels / std::max(pixelsOf(one), 1.0);
    return one;
}

// Appends `count` views for these, or none if there are none.
void addGroups(std::span<const Seen> views, size_t count, const Corrections& corrections, std::vector<PlanView>& to) {
    for (size_t i = 0; i < count && !views.empty(); ++i) {
        const size_t first = views.size() * i / count, end = views.size() * (i + 1) / count;
        if (end > first) to.push_back(standIn(views.subspan(first, end - first), corrections));
    }
}

} // namespace

std::vector<PlanView> alikeViews(std::span<const PlanView> views, const MediumExtent& extent,
                                 const Corrections& corrections) {
    if (views.size() <= kMostPlanViews) return {views.begin(), views.end()};
    std::vector<Seen> seen;
    for (const PlanView& view : views) seen.push_back({placeOf(extent, view), projectedDeviation(extent, view), &view});
    std::ranges::stable_sort(seen, {}, [](const Seen& s) { return std::tuple(s.place, s.deviation); });
    const auto at = [&](Place place) {
        return std::span<const Seen>(std::ranges::lower_bound(seen, place, {}, &Seen::place),
                                     std::ranges::upper_bound(seen, place, {}, &Seen::place));
    };
    const std::span<const Seen> away = at(Place::away), outside = at(Place::outside), inside = at(Place::inside);
    // One for all that see nothing. The others in proportion, but some for either if there are any.
    const size_t left = kMostPlanViews - (away.empty() ? 0 : 1),
                 seeing = std::max(seen.size() - away.size(), size_t(1));
    const size_t least = inside.empty() ? 0 : 1, most = outside.empty() ? left : left - 1;
    const size_t for_inside = std::clamp(left * inside.size() / seeing, least, most);
    std::vector<PlanView> few;
    addGroups(away, 1, corrections, few);
    addGroups(outside, left - for_inside, corrections, few);
    addGroups(inside, for_inside, corrections, few);
    return few;
}

} // namespace brume
