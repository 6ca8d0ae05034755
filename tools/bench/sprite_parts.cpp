#include "tools/bench/sprite_parts.h"

#include <algorithm>
#include <cmath>

#include "shaders/shared/six_way.h"
#include "tools/reference/geometry.h"

namespace brume::bench {

using reference::Interval;
using reference::Ray;

namespace {

constexpr double kPanel = 0.04; // radii; light has kinks wherever its ray begins to meet another ball

} // namespace

SpriteParts::SpriteParts(reference::UnionMedium balls, glm::dvec3 to_light, const reference::Camera& camera,
                         double size, const methods::sprites::LightMaps& maps)
    : balls_(std::move(balls)), to_light_(glm::normalize(to_light)), camera_(camera), size_(size), maps_(maps) {
    for (const reference::UnionMedium::Ball& ball : balls_.balls) lights_.push_back(lightAt(ball.centre));
}

double SpriteParts::lightAt(glm::dvec3 place) const {
    thread_local std::vector<Interval> parts;
    reference::insideUnion(balls_, {place, to_light_}, parts);
    double path = 0;
    for (const Interval part : parts) path += part.end - part.begin;
    return std::exp(-balls_.sigma_t * path);
}

// `at`: -1 ... 1 to the right and up. Texels as shaders/sprite.frag reads them.
SpriteParts::Texel SpriteParts::texelAt(size_t ball, glm::dvec2 at) const {
    const double side = maps_.side;
    const glm::dvec2 texel = glm::clamp(side * glm::dvec2(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y) - 0.5, 0.0, side - 1);
    const glm::uvec2 lo(texel), hi = glm::min(lo + 1u, glm::uvec2(maps_.side - 1));
    const glm::dvec2 part = texel - glm::dvec2(lo);
    const auto read = [&](const std::vector<glm::vec4>& map) {
        const size_t first = ball % maps_.frames * maps_.side * maps_.side;
        const auto row = [&](uint32_t y) {
            const size_t begin = first + size_t(y) * maps_.side;
            return glm::mix(glm::dvec4(map[begin + lo.x]), glm::dvec4(map[begin + hi.x]), part.x);
        };
        return glm::mix(row(lo.y), row(hi.y), part.y);
    };
    const glm::dvec4 positive = read(maps_.positive), negative = read(maps_.negative);
    const glm::vec3 toward = glm::transpose(camera_.world_from_view) * to_light_;
    return {positive.w, double(physics::sixWayLight(toward, glm::vec3(positive), glm::vec3(negative)))};
}

std::vector<SpriteParts::Cover> SpriteParts::coversOf(const Ray& ray, const SpriteWay& way) const {
    std::vector<Cover> covers;
    const glm::dvec3 along = glm::transpose(camera_.world_from_view) * ray.direction;
    for (size_t i = 0; i < balls_.balls.size(); ++i) {
        const reference::UnionMedium::Ball& ball = balls_.balls[i];
        const glm::dvec3 to = ball.centre - ray.origin;
        const glm::dvec3 view = glm::transpose(camera_.world_from_view) * to;
        if (!(view.z < -ball.radius)) continue; // beside or behind the eye: no scene that is taken apart has any
        const double t = view.z / along.z;      // where the ray has the centre's view depth
        const glm::dvec2 off = glm::dvec2(t * along - view) / ball.radius;
        const glm::dvec2 at = off / size_;
        if (way.depth == SpriteWay::Depth::map && std::max(std::abs(at.x), std::abs(at.y)) > 1) continue;
        if (way.depth == SpriteWay::Depth::mean && glm::dot(off, off) > 1) continue;
        if (way.depth == SpriteWay::Depth::chord && glm::dot(off, off) > 1.5) continue; // seen aslant it is wider
        const Texel texel = texelAt(i, at);
        Interval part = reference::insideSphere(ball.centre, ball.radius, ray);
        if (way.depth != SpriteWay::Depth::chord) {
            double length = ball.radius * 4 / 3;
            if (way.depth == SpriteWay::Depth::map) length *= texel.depth * reference::kPi / (4 * size_ * size_);
            part = {t - length / 2, t + length / 2};
        }
        if (part.empty()) continue;
        covers.push_back({part, way.one_light ? lights_[i] : 1, way.map_light ? texel.light : 1, glm::length(to)});
    }
    return covers;
}

// Light that the part scatters toward its begin.
double SpriteParts::scattered(const Ray& ray, Interval part) const {
    const double length = part.end - part.begin;
    double smallest = reference::kInfinity;
    for (const reference::UnionMedium::Ball& ball : balls_.balls) smallest = std::min(smallest, ball.radius);
    const int panels = std::max(int(std::ceil(length / (kPanel * smallest))), 1);
    const double half = length / (2 * panels);
    double sum = 0;
    for (int panel = 0; panel < panels; ++panel)
        for (int i = 0; i < rule_.size(); ++i) {
            const double t = half * (2 * panel + 1 + rule_.node(i));
            sum += rule_.weight(i) * half * std::exp(-balls_.sigma_t * t) * lightAt(ray.at(part.begin + t));
        }
    return balls_.sigma_t * sum;
}

SpriteParts::Seen SpriteParts::overOf(const Ray& ray, const SpriteWay& way) const {
    std::vector<Cover> covers = coversOf(ray, way);
    std::ranges::sort(covers, {}, &Cover::distance);
    Seen seen;
    for (const Cover& cover : covers) {
        const double depth = balls_.sigma_t * (cover.part.end - cover.part.begin);
        const double own = way.one_light ? cover.light * -std::expm1(-depth) : scattered(ray, cover.part);
        seen.light += seen.transmittance * cover.factor * own;
        seen.transmittance *= std::exp(-depth);
    }
    return seen;
}

// From one begin or end of a part to the next the same balls cover the ray.
SpriteParts::Seen SpriteParts::unionOf(const Ray& ray, const SpriteWay& way) const {
    const std::vector<Cover> covers = coversOf(ray, way);
    std::vector<double> ends;
    for (const Cover& cover : covers) ends.insert(ends.end(), {cover.part.begin, cover.part.end});
    std::ranges::sort(ends);
    Seen seen;
    for (size_t i = 1; i < ends.size(); ++i) {
        const Interval part{ends[i - 1], ends[i]};
        double light = 0, factor = 0;
        int count = 0;
        for (const Cover& cover : covers)
            if (cover.part.begin <= part.begin && cover.part.end >= part.end)
                light += cover.light * cover.factor, factor += cover.factor, ++count;
        if (part.empty() || count == 0) continue;
        const double depth = balls_.sigma_t * (part.end - part.begin);
        const double own = way.one_light ? light * -std::expm1(-depth) : factor * scattered(ray, part);
        seen.light += seen.transmittance * own / count;
        seen.transmittance *= std::exp(-depth);
    }
    return seen;
}

SpriteParts::Seen SpriteParts::at(glm::uvec2 pixel, const SpriteWay& way) const {
    const Ray ray = reference::rayThrough(camera_, pixel.x + 0.5, pixel.y + 0.5);
    return way.over ? overOf(ray, way) : unionOf(ray, way);
}

} // namespace brume::bench
