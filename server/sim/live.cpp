#include "server/sim/live.h"

#include <algorithm>

#include "server/sim/kernels.h"
#include "server/sim/state_hash.h"

namespace brume {
namespace {

constexpr float kTicksPerSecond = 60;

// Adds whatever is a list of floats.
template <class T>
void add(StateHash& hash, const std::vector<T>& list) {
    hash.add(std::span(reinterpret_cast<const float*>(list.data()), list.size() * sizeof(T) / sizeof(float)));
}

} // namespace

Live::Live(const Medium& medium, Columns& columns)
    : centre_(medium.centre), albedo_(medium.albedo), unit_(medium.extinction), targets_(medium.count),
      albedos_(medium.count, medium.albedo) {
    // Rows that no message has set are not seen.
    for (uint32_t row = 0; row < medium.count; ++row) place(columns, row, {.place = centre_, .albedo = albedo_});
}

void Live::place(Columns& columns, uint32_t row, const Target& at) {
    columns[Column::home_x][row] = at.place.x;
    columns[Column::home_y][row] = at.place.y;
    columns[Column::home_z][row] = at.place.z;
    columns[Column::scale][row] = at.scale;
    columns[Column::weight][row] = at.extinction;
    albedos_[row] = at.albedo;
    targets_[row] = at;
    targets_[row].left = 0;
}

// One step of equal ones.
void Live::move(Columns& columns, uint32_t row) {
    Target& to = targets_[row];
    if (to.left == 0) return;
    if (to.left == 1) return place(columns, row, to);
    const float part = 1 / static_cast<float>(to.left--);
    const auto approach = [&](Column column, float target) {
        float& now = columns[column][row];
        now += (target - now) * part;
    };
    approach(Column::home_x, to.place.x);
    approach(Column::home_y, to.place.y);
    approach(Column::home_z, to.place.z);
    approach(Column::scale, to.scale);
    approach(Column::weight, to.extinction);
    albedos_[row] += (to.albedo - albedos_[row]) * part;
}

void Live::follow(Columns& columns, Rows rows, glm::vec3 volume) {
    for (uint32_t row = rows.begin; row < rows.end; ++row) {
        columns[Column::x][row] = columns[Column::home_x][row] + volume.x;
        columns[Column::y][row] = columns[Column::home_y][row] + volume.y;
        columns[Column::z][row] = columns[Column::home_z][row] + volume.z;
    }
}

void Live::set(Columns& columns, const SetParticles& particles, const MotionStep& now) {
    const ParticleRows& rows = *particles.rows;
    const auto steps = static_cast<uint32_t>(particles.seconds * kTicksPerSecond + 0.5f);
    const uint32_t stay = std::min(live_, particles.live);
    for (uint32_t row = stay; row < live_; ++row) place(columns, row, targets_[row]); // who goes has arrived
    const auto count = static_cast<uint32_t>(rows.positions.size());
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t row = particles.first + i;
        const Target to{rows.positions[i] + centre_, rows.scales[i], rows.extinctions[i],
                        rows.albedos.empty() ? albedo_ : rows.albedos[i], steps};
        if (row < stay && steps > 0)
            targets_[row] = to;
        else
            place(columns, row, to);
    }
    moving_ = std::max(moving_, steps);
    // Those that came, and those that are at once where they shall be.
    if (steps == 0)
        follow(columns, {std::min(particles.first, stay), std::min(particles.first + count, stay)}, now.volume);
    follow(columns, {stay, particles.live}, now.volume);
    live_ = particles.live;

    StateHash hash;
    for (const uint64_t word :
         {told_, now.number, uint64_t{particles.first}, uint64_t{particles.live}, uint64_t{steps}})
        hash.add(word);
    add(hash, rows.positions);
    add(hash, rows.scales);
    add(hash, rows.extinctions);
    add(hash, rows.albedos);
    told_ = hash.value();
}

void Live::step(Columns& columns, const MotionStep& step) {
    if (moving_ > 0) {
        for (uint32_t row = 0; row < live_; ++row) move(columns, row);
        --moving_;
    }
    follow(columns, {0, live_}, step.volume);
}

void Live::settle(Columns& columns, float extinction) {
    scaleSigma(columns, {0, live_}, unit_ > 0 ? extinction / unit_ : 1);
}

uint64_t Live::bytes() const { return targets_.capacity() * sizeof(Target) + albedos_.capacity() * sizeof(glm::vec3); }

void Live::exchange(StateBytes& bytes, Columns& columns, const MotionStep&) {
    bytes.value(live_);
    bytes.value(moving_);
    bytes.value(told_);
    if (live_ > targets_.size()) throw StateError("a state with more particles than there can be");
    bytes.values(std::span(targets_));
    bytes.values(std::span(albedos_));
    // Rows that are gone come back where they were.
    for (const Column c : {Column::home_x, Column::home_y, Column::home_z, Column::scale, Column::weight})
        bytes.values(std::span(columns[c] + live_, targets_.size() - live_));
}

// The columns are as at the start already.
void Live::restart() {
    live_ = moving_ = 0;
    told_ = 0;
    std::fill(targets_.begin(), targets_.end(), Target{.place = centre_, .albedo = albedo_});
    std::fill(albedos_.begin(), albedos_.end(), albedo_);
}

} // namespace brume
