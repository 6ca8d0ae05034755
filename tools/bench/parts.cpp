#include "tools/bench/parts.h"

#include <cmath>
#include <cstdio>
#include <list>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/scene_reader.h"
#include "tools/bench/error.h"
#include "tools/bench/truth.h"
#include "tools/reference/rows.h"

namespace brume::bench {
namespace {

using nlohmann::json;
using Depth = SpriteWay::Depth;

constexpr double kMedium = 0.999; // transmittance below which a pixel shows the medium

constexpr SpriteWay kAll{true, true, Depth::map, true};
constexpr SpriteStep kSteps[]{
    {"one light a ball", {.one_light = true}, {.one_light = true}, {false, true, Depth::map, true}},
    {"over", {.over = true}, {.one_light = true, .over = true}, {true, false, Depth::map, true}},
    {"mean chord",
     {.depth = Depth::mean},
     {.one_light = true, .over = true, .depth = Depth::mean},
     {true, true, Depth::chord, true}},
    {"depth of maps",
     {.depth = Depth::map},
     {.one_light = true, .over = true, .depth = Depth::map},
     {true, true, Depth::mean, true}},
    {"light of maps", {.map_light = true}, kAll, {true, true, Depth::map, false}},
};

// Pictures of all ways that are asked for, each drawn once.
class Pictures {
public:
    Pictures(const SpriteParts& sprites, const PartsCase& of) : sprites_(sprites), of_(of) {}

    const std::vector<SpriteParts::Seen>& operator[](const SpriteWay& way) {
        for (const auto& [drawn, picture] : all_)
            if (drawn == way) return picture;
        const glm::uvec2 size = thinned(of_.size, of_.every);
        std::vector<SpriteParts::Seen> picture(size_t(size.x) * size.y);
        reference::forRows(int(size.y), 0, [&] {
            return [&](int y) {
                for (uint32_t x = 0; x < size.x; ++x)
                    picture[size_t(y) * size.x + x] = sprites_.at(glm::uvec2(x, y) * of_.every + of_.every / 2, way);
            };
        });
        return all_.emplace_back(way, std::move(picture)).second;
    }

private:
    const SpriteParts& sprites_;
    const PartsCase& of_;
    std::list<std::pair<SpriteWay, std::vector<SpriteParts::Seen>>> all_;
};

} // namespace

std::span<const SpriteStep> spriteSteps() { return kSteps; }

PartsOfError partsOfError(const SpriteParts& sprites, const PartsCase& of) {
    Pictures pictures(sprites, of);
    const std::vector<SpriteParts::Seen>& truth = pictures[{}];
    std::vector<size_t> inside, outside;
    double squares = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        (truth[i].transmittance < kMedium ? inside : outside).push_back(i);
        if (truth[i].transmittance < kMedium) squares += truth[i].light * truth[i].light;
    }
    PartsOfError out;
    out.pixels = inside.size();
    using Field = std::vector<double>; // of the pixels inside
    const auto apart = [&](const SpriteWay& a, const SpriteWay& b) {
        const std::vector<SpriteParts::Seen>&one = pictures[a], &other = pictures[b];
        Field field;
        for (const size_t i : inside) field.push_back(one[i].light - other[i].light);
        return field;
    };
    const auto product = [&](const Field& a, const Field& b) {
        double sum = 0;
        for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
        return sum / squares;
    };
    const auto rms = [&](const Field& field) { return std::sqrt(product(field, field)); };
    std::vector<Field> steps;
    SpriteWay before;
    for (const SpriteStep& step : kSteps) {
        const Field& field = steps.emplace_back(apart(step.chain, before));
        const Field ones(field.size(), 1);
        out.parts.push_back({step.name, rms(apart(step.alone, {})), rms(field), rms(apart(step.all_but, {})),
                             product(field, ones) / std::sqrt(product(ones, ones))});
        before = step.chain;
    }
    const Field whole = apart(kAll, {});
    Field lacks = whole;
    for (const Field& a : steps) {
        std::vector<double>& row = out.products.emplace_back();
        for (const Field& b : steps) row.push_back(product(a, b));
        for (size_t i = 0; i < a.size(); ++i) lacks[i] -= a[i];
    }
    out.whole = rms(whole), out.closure = rms(lacks);
    const std::vector<SpriteParts::Seen>& all = pictures[kAll];
    Field drawn;
    const RadianceImage picture = thinned(of.picture, of.every);
    for (const size_t i : inside) drawn.push_back(double(picture.radiance[i].r) / of.light - all[i].light);
    out.drawn = rms(drawn);
    double added = 0;
    for (const size_t i : outside) added += std::pow(all[i].light - truth[i].light, 2);
    out.outside = std::sqrt(added / squares);
    return out;
}

json partsRows(const gpu::Device& device, const std::vector<NamedCase>& cases, glm::uvec2 size, uint32_t every,
               uint32_t ticks) {
    json rows = json::array();
    for (const NamedCase& one : cases) {
        Stage stage(device, one.wanted, ticks);
        const Scene& scene = stage.scene();
        const SceneNow& now = stage.simulation().now();
        const Medium& medium = now.medium;
        if (now.render.method != "sprites" || medium.anisotropy != 0 || !scene.boxes.empty() || !scene.planes.empty() ||
            !scene.spheres.empty() || !isMediumAlone(scene) || now.render.sprites.maps == "files")
            throw SceneError(one.wanted.scene + ": kind parts is of render.method=sprites with maps of its own, "
                                                "isotropic, without objects");
        const std::vector<gpu::Particle> particles = stage.particles();
        const methods::sprites::LightMaps maps =
            now.render.sprites.maps == "even" ? methods::sprites::evenMaps() : methods::sprites::bakedMaps();
        const SpriteParts sprites(
            reference::unionOf(particles, double(medium.union_radius), double(medium.union_extinction), glm::dvec3(1)),
            now.light.to_light, reference::perspective(stage.pose(), int(size.x), int(size.y)),
            double(now.render.sprites.size), maps);
        const double light = double(medium.albedo.r * now.light.irradiance.r) / (4 * std::numbers::pi);
        const PartsOfError parts = partsOfError(sprites, {size, every, stage.picture(stage.pose(), size), light});
        json row = {{"scene", one.wanted.scene}, {"camera", one.wanted.camera}, {"variant", one.name},
                    {"set", one.wanted.set},     {"pixels", parts.pixels},      {"whole", parts.whole},
                    {"closure", parts.closure},  {"drawn", parts.drawn},        {"outside", parts.outside},
                    {"products", parts.products}};
        for (const PartsOfError::Part& part : parts.parts)
            row["parts"].push_back({{"name", part.name},
                                    {"alone", part.alone},
                                    {"step", part.step},
                                    {"all_but", part.all_but},
                                    {"bias", part.bias}});
        std::fprintf(stderr, "  %-12s %-8s parts %-28s %.2f %%, the device's picture differs by %.2g %%\n",
                     one.wanted.scene.c_str(), one.wanted.camera.c_str(), one.name.c_str(), 100 * parts.whole,
                     100 * parts.drawn);
        rows.push_back(std::move(row));
    }
    return rows;
}

std::string partsTables(const json& series) {
    std::string out;
    const auto percent = [](const json& number) { return fmt::format("{:.2f}", 100 * number.get<double>()); };
    for (const json& row : series.at("rows")) {
        out += fmt::format("### `{}`, {}, {}\n\n{} pixels. In per cent of the truth's root mean square.\n\n",
                           row.value("scene", ""), row.value("camera", ""), row.value("variant", ""),
                           row.value("pixels", 0));
        out += "| part | alone | step of the chain | its mean | the method without it |";
        const json &parts = row.at("parts"), &products = row.at("products");
        for (const json& part : parts) out += fmt::format(" with {} |", part.value("name", ""));
        out += "\n|---|---|---|---|---|";
        for (size_t i = 0; i < parts.size(); ++i) out += "---|";
        double squares = 0;
        for (size_t i = 0; i < parts.size(); ++i) {
            const json& part = parts[i];
            out += fmt::format("\n| {} | {} | {} | {} | {} |", part.value("name", ""), percent(part.at("alone")),
                               percent(part.at("step")), percent(part.at("bias")), percent(part.at("all_but")));
            for (size_t j = 0; j < parts.size(); ++j) { // the cosine between two steps
                const double both = part.value("step", 0.0) * parts[j].value("step", 0.0);
                out += fmt::format(" {:.2f} |", both > 0 ? products[i][j].get<double>() / both : 0);
            }
            squares += std::pow(part.value("step", 0.0), 2);
        }
        out += fmt::format("\n\nThe method: {} %. Root of the sum of squares: {:.2f} %. Outside the medium: {} %. The "
                           "device's picture beside the method in double precision: {:.2g} %. The steps' sum lacks "
                           "{:.1e}.\n\n",
                           percent(row.at("whole")), 100 * std::sqrt(squares), percent(row.at("outside")),
                           100 * row.value("drawn", 0.0), row.value("closure", 0.0));
    }
    return out;
}

} // namespace brume::bench
