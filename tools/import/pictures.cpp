#include "tools/import/pictures.h"

#include <algorithm>
#include <cmath>

#include "common/random.h"
#include "tools/import/parallel.h"
#include "tools/import/path.h"

namespace brume::volumes {

namespace {

// Parts of a ray; each is lit as its middle is, in both pictures.
constexpr double kPart = 2; // voxels
constexpr int kMostParts = 64;

} // namespace

Pictures::Pictures(const Voxels& voxels, double per_value, int side, int count, uint64_t seed)
    : voxels_(voxels), per_value_(per_value), side_(side) {
    for (int i = 0; i < count; ++i) {
        Random numbers(seed, uint64_t(i));
        View& view = views_.emplace_back();
        view.toward = glm::normalize(glm::dvec3(numbers.direction()));
        view.sun = glm::normalize(glm::dvec3(numbers.direction()));
        view.u = acrossOf(view.toward);
        view.v = glm::cross(view.toward, view.u);
        view.light.resize(size_t(side) * size_t(side));
    }
    forPixels(
        [&](size_t n, int pixel) { views_[n].light[size_t(pixel)] = lightOf(views_[n], pixel, voxels.values()); });
}

template <class Visit>
void Pictures::forPixels(const Visit& visit) const {
    parallelFor(views_.size() * size_t(side_), [&](size_t row) {
        const size_t n = row / size_t(side_), first = row % size_t(side_) * size_t(side_);
        for (int column = 0; column < side_; ++column) visit(n, int(first) + column);
    });
}

double Pictures::lightOf(const View& view, int pixel, std::span<const float> values) const {
    const glm::dvec3 middle = glm::dvec3(voxels_.lo() + voxels_.hi()) / 2.0;
    const glm::dvec3 half = glm::dvec3(voxels_.hi() - voxels_.lo()) / 2.0 + 1.0;
    const int column = pixel % side_, row = pixel / side_;
    const double u = (column + 0.5) * 2 / side_ - 1, v = (row + 0.5) * 2 / side_ - 1;
    const glm::dvec3 through =
        middle + view.u * (u * glm::dot(half, glm::abs(view.u))) + view.v * (v * glm::dot(half, glm::abs(view.v)));
    const Part within = partWithin(voxels_, through, view.toward);
    if (!(within.from < within.to)) return 0;
    const double length = within.to - within.from;
    const int parts = std::clamp(int(std::ceil(length / kPart)), 1, kMostParts);
    const auto at = [&](double part) { return within.from + length * part / parts; };
    double light = 0, depth = 0;
    for (int i = 0; i < parts; ++i) {
        const double own = per_value_ * integralAlong(voxels_, values, through, view.toward, {at(i), at(i + 1)});
        if (own > 0) {
            const glm::dvec3 place = through + at(i + 0.5) * view.toward;
            const double to_sun = per_value_ * integralAlong(voxels_, values, place, view.sun, {.from = 0});
            light += std::exp(-depth - to_sun) * -std::expm1(-own);
        }
        depth += own;
    }
    return light;
}

double Pictures::errorOf(std::span<const float> values) const {
    std::vector<std::vector<double>> off(views_.size());
    for (size_t n = 0; n < views_.size(); ++n) off[n].resize(views_[n].light.size());
    forPixels([&](size_t n, int pixel) {
        off[n][size_t(pixel)] = lightOf(views_[n], pixel, values) - views_[n].light[size_t(pixel)];
    });
    double of_off = 0, of_light = 0;
    for (size_t n = 0; n < views_.size(); ++n)
        for (size_t i = 0; i < off[n].size(); ++i) {
            of_off += off[n][i] * off[n][i];
            of_light += views_[n].light[i] * views_[n].light[i];
        }
    return std::sqrt(of_off / of_light);
}

} // namespace brume::volumes
