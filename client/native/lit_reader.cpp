#include "client/native/lit_reader.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace brume::client {
namespace {

constexpr uint32_t kMostObjects = 64;

bool finite(const wire::Vec3& v) { return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z()); }

} // namespace

std::string LitReader::problemOf(const wire::LitParticles& m) {
    if (m.number() == 0) return "lit particles without a number";
    if (m.count() > lit::kMostParticles)
        return fmt::format("{} lit particles; at most {}", m.count(), lit::kMostParticles);
    if (m.present() >> lit::kColumns != 0) return "columns of lit particles that this program does not know";
    if (m.hues()->size() < 1 || m.hues()->size() > lit::kHues) return "lit particles without one to three hues";
    if (m.phase()->size() != 4) return "lit particles without the four numbers of a phase function";
    if (m.objects() && m.objects()->size() > kMostObjects)
        return fmt::format("{} objects among lit particles; at most {}", m.objects()->size(), kMostObjects);
    bool all = std::isfinite(m.step()) && m.step() > 0 && std::isfinite(m.falloff()) && m.falloff() > 0 &&
               std::isfinite(m.mean_cosine()) && std::isfinite(m.haze()) && std::isfinite(m.exposure());
    for (const wire::Vec3* v : {m.origin(), m.to_light(), m.irradiance(), m.ambient(), m.straight(), m.zenith(),
                                m.horizon(), m.emission(), m.cold_albedo()})
        all = all && (!v || finite(*v));
    for (const float number : *m.phase()) all = all && std::isfinite(number);
    for (const wire::Hue* hue : *m.hues()) all = all && std::isfinite(hue->extinction());
    if (m.objects())
        for (const wire::Object* o : *m.objects())
            all =
                all && finite(o->centre()) && finite(o->half_size()) && finite(o->albedo()) && std::isfinite(o->yaw());
    if (!all) return "lit particles with numbers that are none";
    if (const wire::Vec3* cold = m.cold_albedo(); cold && !(std::min({cold->x(), cold->y(), cold->z()}) > 0))
        return "lit particles whose cold_albedo is not above 0";
    return "";
}

const lit::Rows* LitReader::read(const wire::LitParticles& m, std::span<const uint8_t> bytes) {
    why_ = problemOf(m);
    if (!why_.empty()) return nullptr;
    const lit::Rows* reference = nullptr;
    if (m.reference() != 0) {
        const auto& held = held_[lit::layerOf(m.reference())];
        if (held.first != m.reference()) {
            why_ = fmt::format("lit particles {} are changes to {}, which never came", m.number(), m.reference());
            return nullptr;
        }
        reference = &held.second;
    }
    auto rows = lit::unpack(m.first(), m.count(), m.present(), bytes, reference);
    if (!rows) {
        why_ = "columns of lit particles that are broken";
        return nullptr;
    }
    auto& held = held_[lit::layerOf(m.number())];
    held = {m.number(), std::move(*rows)};
    return &held.second;
}

} // namespace brume::client
