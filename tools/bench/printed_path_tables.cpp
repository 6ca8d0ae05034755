// Measures the time of the printed path, and what icosahedra change.
#include <ctime>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/sim/simulation.h"
#include "tools/bench/printed_path.h"
#include "tools/bench/stage.h"
#include "tools/reference/geometry.h"

namespace brume::bench {
namespace {

using nlohmann::json;
using reference::Interval;
using reference::Ray;
using reference::UnionMedium;

constexpr uint32_t kCounts[] = {250, 500, 750, 1000, 1250, 1500}, kCutoffs[] = {20, 40, 60, 80, 100, 120};
constexpr uint32_t kFigureCount = 750, kFigureCutoff = 60; // of the thesis's figures 5.9 and 5.7
const glm::dvec3 kAbove(0, 1, 0), kRight = glm::normalize(glm::dvec3(1, 0.05, 0));

// Balls of `tubes-union`, the same volume together for any number.
UnionMedium ballsOf(uint32_t count) {
    const double radius = 0.12 * std::cbrt(750.0 / count);
    Case wanted{.scene = "tubes-union",
                .set = {fmt::format("medium.count={}", count), fmt::format("medium.union_radius={}", radius)}};
    const Scene scene = sceneOf(wanted);
    const Simulation simulation(scene);
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);
    return reference::unionOf(particles, radius, double(scene.medium.union_extinction), glm::dvec3(1));
}

using Rays = std::vector<std::vector<PathHit>>; // the hits of each

Rays raysOf(uint32_t count) {
    const UnionMedium balls = ballsOf(count);
    Rays rays;
    for (size_t i = 0; i < balls.balls.size(); ++i) rays.push_back(hitsOf(balls, i, kRight));
    return rays;
}

// Of this thread on its core, s. Rays take little enough for others to come between in every run.
double threadSeconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

// The least time of a ray, us.
double timeOf(const Rays& rays, uint32_t repeats, const std::function<float(const std::vector<PathHit>&)>& path) {
    double least = std::numeric_limits<double>::infinity();
    volatile float sink = 0;
    for (uint32_t repeat = 0; repeat < repeats; ++repeat) {
        const double begin = threadSeconds();
        float sum = 0;
        for (const std::vector<PathHit>& hits : rays) sum += path(hits);
        sink = sum;
        least = std::min(least, threadSeconds() - begin);
    }
    (void)sink;
    return 1e6 * least / double(rays.size());
}

// As the compute pass: a full row of slots is black and nothing is done; what has no hit is walked all the same.
double printedTime(const Rays& rays, uint32_t repeats, uint32_t cutoff, PathSort sort) {
    std::vector<PathHit> slots(cutoff);
    return timeOf(rays, repeats, [&](const std::vector<PathHit>& hits) {
        if (hits.size() >= cutoff) return 0.0f;
        std::ranges::fill(std::ranges::copy(hits, slots.begin()).out, slots.end(), PathHit{});
        return printedPath(slots, sort);
    });
}

double mergedTime(const Rays& rays, uint32_t repeats, uint32_t cutoff) {
    return timeOf(rays, repeats,
                  [&](const std::vector<PathHit>& hits) { return hits.size() >= cutoff ? 0.0f : mergedPath(hits); });
}

// A row for each of `axis`.
json rowsOver(std::span<const uint32_t> axis, uint32_t repeats,
              const std::function<std::pair<uint32_t, uint32_t>(uint32_t)>& count_cutoff) {
    json rows = json::array();
    for (const uint32_t value : axis) {
        const auto [count, cutoff] = count_cutoff(value);
        const Rays rays = raysOf(count);
        double sum = 0, black = 0;
        size_t most = 0;
        for (const std::vector<PathHit>& hits : rays) {
            sum += double(hits.size()), most = std::max(most, hits.size());
            if (hits.size() >= cutoff) black += 1;
        }
        rows.push_back({{"variant", std::to_string(value)},
                        {"hits", sum / double(rays.size())},
                        {"most_hits", most},
                        {"black", black / double(rays.size())},
                        {"all_slots_us", printedTime(rays, repeats, cutoff, PathSort::slots)},
                        {"until_sorted_us", printedTime(rays, repeats, cutoff, PathSort::early)},
                        {"slots_with_hits_us", printedTime(rays, repeats, cutoff, PathSort::stored)},
                        {"merged_us", mergedTime(rays, repeats, cutoff)},
                        {"merged_all_us", mergedTime(rays, repeats, std::numeric_limits<uint32_t>::max())}});
    }
    return rows;
}

double lengthOf(std::vector<Interval> parts) {
    std::ranges::sort(parts, {}, &Interval::begin);
    double end = 0, sum = 0; // of the ray from 0 on
    for (const Interval part : parts) {
        sum += std::max(part.end - std::max(part.begin, end), 0.0);
        end = std::max(end, part.end);
    }
    return sum;
}

// Paths from the centres toward the light within icosahedra, over those within balls.
json icosahedraRows() {
    json rows = json::array();
    for (const uint32_t count : {250u, 750u, 1500u})
        for (const glm::dvec3& to_light : {kAbove, kRight}) {
            const UnionMedium medium = ballsOf(count);
            double sums[2] = {}, lights[2] = {};
            for (const UnionMedium::Ball& from : medium.balls) {
                const Ray ray{from.centre, to_light};
                std::vector<Interval> parts[2];
                for (const UnionMedium::Ball& ball : medium.balls) {
                    const Interval within[] = {reference::insideSphere(ball.centre, ball.radius, ray),
                                               insideIcosahedron(ball.centre, ball.radius, ray)};
                    for (int i = 0; i < 2; ++i)
                        if (!within[i].empty() && within[i].end > 0) parts[i].push_back(within[i]);
                }
                for (int i = 0; i < 2; ++i) {
                    const double path = lengthOf(parts[i]);
                    sums[i] += path / double(medium.balls.size());
                    lights[i] += std::exp(-medium.sigma_t * path) / double(medium.balls.size());
                }
            }
            rows.push_back({{"variant", std::to_string(count)},
                            {"light", to_light == kAbove ? "from above" : "from the right"},
                            {"path_balls", sums[0]},
                            {"path_icosahedra", sums[1]},
                            {"light_balls", lights[0]},
                            {"light_icosahedra", lights[1]}});
        }
    return rows;
}

} // namespace

json printedPathSeries(uint32_t repeats) {
    const auto series = [](const char* name, const char* about, json rows) {
        return json{{"name", name}, {"about", about}, {"baseline", ""}, {"rows", std::move(rows)}};
    };
    return {series("By cut-off", "750 balls of tubes-union, light from the right.",
                   rowsOver(kCutoffs, repeats, [](uint32_t c) { return std::pair(kFigureCount, c); })),
            series("By number of balls", "Cut-off 60.",
                   rowsOver(kCounts, repeats, [](uint32_t n) { return std::pair(n, kFigureCutoff); })),
            series("Icosahedra", "Their corners lie on the balls.", icosahedraRows())};
}

} // namespace brume::bench
