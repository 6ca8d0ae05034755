// What a picture shows of the light that points and spots send to the particles. Laws of their errors are sums over
// that.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace brume {

struct PlanScene;
struct PlanView;

// Local light of one view. Parts are of the sum over the medium's pixels of squared radiance, the sun's among it. The
// brightest lights stand for the others.
class ShownLights {
public:
    ShownLights(const PlanScene& scene, const PlanView& view);

    // Light by how steeply it falls within particles. `bend`: 1 / m^2, one over the squared distance from the light. A
    // sixth of the relative second derivative along a ray.
    struct Bend {
        double bend = 0, part = 0;
    };
    std::span<const Bend> bends() const { return {bends_.data(), bend_count_}; }

    // Light by the size of the particles that it comes from. `projected`: pixels of a deviation.
    struct Size {
        double projected = 0, part = 0;
    };
    std::span<const Size> sizes() const { return {sizes_.data(), size_count_}; }

    // The glow right around a light that stands in the medium. `length`: m, in which extinction changes by itself;
    // `projected`: that in pixels.
    struct Core {
        double length = 0, projected = 0, part = 0;
    };
    std::span<const Core> cores() const { return cores_; }

    // What volumes of depth leave, whatever the settings: their directions and their distances, both relative RMSE.
    double directions() const { return directions_; }
    double shells() const { return shells_; }

private:
    static constexpr size_t kBins = 32;
    std::array<Bend, kBins> bends_{};
    std::array<Size, kBins> sizes_{};
    size_t bend_count_ = 0, size_count_ = 0;
    std::vector<Core> cores_;
    double directions_ = 0, shells_ = 0;
};

} // namespace brume
