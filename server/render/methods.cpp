#include "server/render/method.h"

#include <algorithm>

#include "common/scene_limits.h"
#include "server/render/background.h"
#include "server/render/compose.h"
#include "server/render/drawn_cells.h"
#include "server/render/methods/grid.h"
#include "server/render/methods/isv.h"
#include "server/render/methods/slabs.h"
#include "server/render/methods/sphere.h"
#include "server/render/methods/tiles.h"

namespace brume {
namespace {

constexpr const char* kQuadratures[] = {"simpson", "transmittance", "analytic", "cached", "hermite"};
constexpr std::span kOfIsv = std::span(kQuadratures).first(3), kOfTiles = std::span(kQuadratures).last(2);

constexpr MethodInfo kMethods[] = {
    {"slabs", "order-independent slabs on a coarse grid of rays, the full Gaussian, no sort", {}, makeSlabs},
    {"grid", "slabs sampled from a grid in world space that all viewers share, the full Gaussian", {}, makeGrid},
    {"sphere", "sphere proxies, the full Gaussian, 2-point Gauss-Hermite", {}, makeSphere},
    {"tiles", "compute tiles, the full Gaussian, light cached on particles or 2-point Gauss-Hermite", kOfTiles, makeTiles},
    {"isv", "interval shaded volumetrics, tetrahedron support (seed 000)", kOfIsv, makeIsv},
};

const MethodInfo* find(const std::string& method) {
    const auto found = std::find_if(std::begin(kMethods), std::end(kMethods), [&](const auto& m) { return method == m.name; });
    return found == std::end(kMethods) ? nullptr : found;
}

} // namespace

std::span<const MethodInfo> methods() { return kMethods; }
std::span<const char* const> quadratures() { return kQuadratures; }

std::string_view quadratureOf(const RenderSettings& settings) {
    const MethodInfo* method = find(settings.method);
    if (!method || method->quadratures.empty()) return {};
    for (const char* name : method->quadratures)
        if (settings.quadrature == name) return name;
    return method->quadratures.front();
}

std::string checkSettings(const RenderSettings& settings) {
    if (!find(settings.method)) {
        std::string all;
        for (const MethodInfo& m : kMethods) all += std::string(all.empty() ? "" : ", ") + m.name;
        return "no method '" + settings.method + "'; there are: " + all;
    }
    if (std::find(std::begin(kQuadratures), std::end(kQuadratures), settings.quadrature) == std::end(kQuadratures)) {
        std::string all;
        for (const char* name : kQuadratures) all += std::string(all.empty() ? "" : ", ") + name;
        return "no quadrature '" + settings.quadrature + "'; there are: " + all;
    }
    const uint32_t most = settings.quadrature == "transmittance" ? 3 : 10;
    if (settings.steps < 1 || settings.steps > most)
        return "steps must be 1 ... " + std::to_string(most) + " for quadrature '" + settings.quadrature + "'";
    if (!limits::kMerge.holds(double(settings.merge))) return "merge must be 0 ... " + std::to_string(int(limits::kMerge.hi));
    return {};
}

std::unique_ptr<Method> makeMethod(const MethodContext& context) {
    if (const MethodInfo* method = find(context.settings.method)) return method->make(context);
    throw gpu::Error(checkSettings(context.settings));
}

void Method::record(gpu::Commands& commands, std::span<const EyeInputs> eyes) {
    for (const EyeInputs& in : eyes) {
        in.background->record(commands, in);
        if (in.particle_count > 0 && in.nodes) {
            in.cells->begin(commands, *in.nodes);
            recordMedium(commands, *in.nodes);
            in.cells->record(commands, in);
        }
        if (in.particle_count > 0) recordMedium(commands, in);
        in.compose->record(commands, in);
    }
}

} // namespace brume
