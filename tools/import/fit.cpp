#include "tools/import/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "tools/import/octree.h"
#include "tools/import/pictures.h"

namespace brume::volumes {

namespace {

constexpr int kMostFits = 9;
constexpr double kNearEnough = 0.92; // of the bound: no price is searched for that saves more
constexpr double kUsualPower = 0.35; // errors go about as price^0.35
constexpr double kHardlyFewer = 0.9; // Gaussians for each voxel: more of them change little
constexpr double kLeastPrice = 1e-18, kMostPrice = 1;

// The least price at which no more than so many are chosen.
double priceOf(const Octree& tree, uint64_t most) {
    double lo = std::log(kLeastPrice), hi = std::log(kMostPrice);
    if (tree.choose(kLeastPrice).size() <= most) return kLeastPrice;
    for (int i = 0; i < 24; ++i) {
        const double middle = (lo + hi) / 2;
        (tree.choose(std::exp(middle)).size() <= most ? hi : lo) = middle;
    }
    return std::exp(hi);
}

// Prices that were tried, as logarithms, with their errors.
class Search {
public:
    Search(double bound, double least_price) : bound_(std::log(bound)), least_(std::log(least_price)) {}

    void add(double price, double error) { tried_[std::log(price)] = std::log(error); }
    // The price to try next; 0: no other one is worth it.
    double next() const {
        auto low = tried_.end(); // the dearest within the bound
        for (auto i = tried_.begin(); i != tried_.end(); ++i)
            if (i->second <= bound_) low = i;
        const double near_enough = bound_ + std::log(kNearEnough), aim = (bound_ + near_enough) / 2;
        if (low != tried_.end() && low->second >= near_enough) return 0;
        const auto from = low != tried_.end() ? low : tried_.begin();
        double price = from->first + std::clamp((aim - from->second) / kUsualPower, -4.0, 4.0);
        if (low != tried_.end() && std::next(low) != tried_.end()) {
            const auto high = std::next(low); // beyond the bound
            if (high->first - low->first < 0.1) return 0;
            const double part = (aim - low->second) / (high->second - low->second);
            price = low->first + std::clamp(part, 0.1, 0.9) * (high->first - low->first);
        }
        price = std::clamp(price, least_, std::log(kMostPrice));
        for (const auto& [was, error] : tried_)
            if (std::abs(was - price) < 1e-6) return 0;
        return std::exp(price);
    }

private:
    double bound_, least_;
    std::map<double, double> tried_;
};

// What fits are measured by.
struct Seen {
    Rays rays;
    Pictures pictures;
    Seen(const Voxels& voxels, double per_value) : rays(voxels, per_value), pictures(voxels, per_value) {}
};

Fit fitted(const Voxels& voxels, const FitSettings& settings, const Shape& shape, const Seen& seen,
           std::vector<Kernel> kernels, Follow follow) {
    Mixture mixture(voxels, shape, std::move(kernels));
    mixture.refine(settings.rounds, follow);
    mixture.keepMass();
    Fit out;
    out.kernels = mixture.kernels();
    out.error = seen.rays.errorOf(out.kernels);
    out.error.picture = seen.pictures.errorOf(mixture.sums());
    out.kept = out.error.worst() <= settings.error;
    return out;
}

// Within the bound rather than not, then with fewer Gaussians, or else with a smaller error.
bool better(const Fit& a, const Fit& b) {
    if (a.kept != b.kept) return a.kept;
    return a.kept ? a.kernels.size() < b.kernels.size() : a.error.worst() < b.error.worst();
}

std::vector<Kernel> latticeOf(const Voxels& voxels, const Shape& shape) {
    std::map<std::tuple<int, int, int>, double> masses;
    forActive(voxels, [&](glm::ivec3 voxel, float value) {
        const glm::ivec3 cell(glm::floor((glm::dvec3(voxel) + 0.5) / shape.width));
        masses[{cell.x, cell.y, cell.z}] += double(value);
    });
    std::vector<Kernel> out;
    for (const auto& [cell, mass] : masses)
        out.push_back(kernelOf(shape, 0, {std::get<0>(cell), std::get<1>(cell), std::get<2>(cell)}, float(mass)));
    return out;
}

} // namespace

Fit fit(const Voxels& voxels, const FitSettings& settings) {
    const Seen seen(voxels, settings.per_value);
    const Octree tree(voxels, settings.shape, settings.per_value, settings.ellipsoids);
    const Follow follow = settings.ellipsoids ? Follow::place_and_axes : Follow::place_and_width;
    const double least = priceOf(tree, settings.most);
    Search search(settings.error, least);
    Fit best;
    int tried = 0;
    for (double price = std::clamp(1e-3 * settings.error * settings.error, least, kMostPrice);
         price > 0 && tried < kMostFits; price = search.next()) {
        std::vector<Kernel> chosen = tree.choose(price);
        if (chosen.empty()) chosen = tree.choose(least);
        Fit now = fitted(voxels, settings, settings.shape, seen, std::move(chosen), follow);
        search.add(price, now.error.worst());
        const bool hopeless = !now.kept && double(now.kernels.size()) > kHardlyFewer * double(voxels.active());
        if (tried++ == 0 || better(now, best)) best = std::move(now);
        if (hopeless) break;
    }
    best.all = least == kLeastPrice;
    return best;
}

Fit fitLattice(const Voxels& voxels, const FitSettings& settings, double& spacing) {
    const Seen seen(voxels, settings.per_value);
    const auto at = [&](double width) {
        Shape shape = settings.shape;
        shape.width = width;
        return fitted(voxels, settings, shape, seen, latticeOf(voxels, shape), Follow::nothing);
    };
    spacing = 1;
    Fit best = at(spacing);
    double lo = 1, hi = 8;
    for (int tried = 0; best.kept && tried < 7; ++tried) {
        const double middle = std::sqrt(lo * hi);
        Fit now = at(middle);
        (now.kept ? lo : hi) = middle;
        if (now.kept) best = std::move(now), spacing = middle;
    }
    return best;
}

} // namespace brume::volumes
