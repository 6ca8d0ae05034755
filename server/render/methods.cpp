#include "server/render/method.h"

#include <algorithm>

#include "server/render/methods/isv.h"
#include "server/render/methods/sphere.h"

namespace brume {
namespace {

constexpr MethodInfo kMethods[] = {
    {"sphere", "sphere proxies, the full Gaussian, 2-point Gauss-Hermite", makeSphere},
    {"isv", "interval shaded volumetrics, tetrahedron support (seed 000)", makeIsv},
};
constexpr const char* kQuadratures[] = {"simpson", "transmittance", "analytic"};

} // namespace

std::span<const MethodInfo> methods() { return kMethods; }
std::span<const char* const> quadratures() { return kQuadratures; }

std::string checkSettings(const RenderSettings& settings) {
    const auto known = [&](const auto& m) { return settings.method == m.name; };
    if (std::none_of(std::begin(kMethods), std::end(kMethods), known)) {
        std::string all;
        for (const MethodInfo& m : kMethods) all += std::string(all.empty() ? "" : ", ") + m.name;
        return "no method '" + settings.method + "'; there are: " + all;
    }
    if (std::find(std::begin(kQuadratures), std::end(kQuadratures), settings.quadrature) == std::end(kQuadratures))
        return "no quadrature '" + settings.quadrature + "'; there are: simpson, transmittance, analytic";
    const uint32_t most = settings.quadrature == "transmittance" ? 3 : 10;
    if (settings.steps < 1 || settings.steps > most)
        return "steps must be 1 ... " + std::to_string(most) + " for quadrature '" + settings.quadrature + "'";
    return {};
}

std::unique_ptr<Method> makeMethod(const MethodContext& context) {
    for (const MethodInfo& m : kMethods)
        if (context.settings.method == m.name) return m.make(context);
    throw gpu::Error(checkSettings(context.settings));
}

} // namespace brume
