#include "server/sim/plume.h"

#include <algorithm>
#include <cmath>

#include "common/elementary.h"
#include "common/random.h"

namespace brume {

Plume::Plume(const Medium& medium)
    : emitter_(medium.emitter), albedo_(medium.albedo), albedos_(emitter_.cooling == glm::vec3(0) ? 0 : medium.count),
      scale_(medium.scale), multiplier_(medium.multiplier), seed_(medium.seed), pool_(medium.count),
      turbulence_(medium.seed, emitter_.turbulence, emitter_.eddy, emitter_.wind) {}

uint64_t Plume::runUp() const {
    return static_cast<uint64_t>(std::ceil(static_cast<double>(emitter_.life) / kTickSeconds)) + 1;
}

std::array<Rows, 2> Plume::living() const {
    if (oldest_ == born_) return {};
    const auto first = static_cast<uint32_t>(oldest_ % pool_), end = static_cast<uint32_t>((born_ - 1) % pool_ + 1);
    if (first < end) return {{{first, end}, {}}};
    return {{{first, pool_}, {0, end}}};
}

void Plume::step(Columns& columns, const MotionStep& step) {
    const double now = static_cast<double>(step.number) * kTickSeconds;
    const PlumeStep s{.dt = static_cast<float>(kTickSeconds),
                      .viscosity = step.settings.viscosity,
                      .wind = emitter_.wind,
                      .buoyancy = emitter_.buoyancy,
                      .life = emitter_.life};
    for (const Rows rows : living()) plumeStep(columns, rows, s, turbulence_.at(now));
    while (oldest_ < born_ && columns[Column::age][oldest_ % pool_] >= emitter_.life) ++oldest_;
    // From the number of steps, not from a running sum: rounding cannot pile up.
    const auto due = static_cast<uint64_t>(static_cast<double>(emitter_.rate) * now);
    while (born_ < due) bear(columns, now, step.volume);
}

void Plume::settle(Columns& columns, float extinction) {
    for (const Rows rows : living())
        age(columns, rows, {.life = emitter_.life, .growth = emitter_.growth, .extinction = extinction});
    if (!albedos_.empty()) cool(columns);
}

void Plume::cool(const Columns& columns) {
    for (const Rows rows : living())
        for (uint32_t row = rows.begin; row < rows.end; ++row)
            for (int c = 0; c < 3; ++c) {
                const float cooling = emitter_.cooling[c];
                const float hot =
                    cooling > 0
                        ? static_cast<float>(exponential(static_cast<double>(-columns[Column::age][row] / cooling)))
                        : 0;
                albedos_[row][c] = albedo_[c] + hot * (emitter_.albedo[c] - albedo_[c]);
            }
}

void Plume::exchange(StateBytes& bytes, Columns&, const MotionStep&) {
    bytes.value(born_);
    bytes.value(oldest_);
    if (oldest_ > born_ || born_ - oldest_ > pool_) throw StateError("a state with more particles than there can be");
}

// What birth number n is like depends on the seed and n alone; where it is now, on how long ago within this step it
// came.
void Plume::bear(Columns& columns, double now, glm::vec3 volume) {
    if (born_ - oldest_ == pool_) ++oldest_;
    const size_t row = born_ % pool_;
    Random random(seed_, born_);
    const auto age =
        static_cast<float>(std::max(0.0, now - static_cast<double>(born_ + 1) / static_cast<double>(emitter_.rate)));
    const glm::vec2 on_disc = random.inDisc() * emitter_.radius;
    const glm::vec3 velocity = emitter_.velocity + random.inBall() * emitter_.spread;
    const glm::vec3 place = emitter_.position + volume + glm::vec3(on_disc.x, 0, on_disc.y) + velocity * age;
    columns[Column::x][row] = place.x;
    columns[Column::y][row] = place.y;
    columns[Column::z][row] = place.z;
    columns[Column::vx][row] = velocity.x;
    columns[Column::vy][row] = velocity.y;
    columns[Column::vz][row] = velocity.z;
    columns[Column::age][row] = age;
    columns[Column::birth_scale][row] = random.uniform(scale_.lo, scale_.hi);
    columns[Column::weight][row] = random.uniform(multiplier_.lo, multiplier_.hi) * 1e-4f;
    ++born_;
}

} // namespace brume
