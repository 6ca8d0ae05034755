#include "tools/bench/fits.h"

#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

namespace brume::bench {
namespace {

// R^2 of values that a law gives.
template <class Law>
double explained(std::span<const double> x, std::span<const double> y, const Law& law) {
    double mean = 0, left = 0, all = 0;
    for (const double value : y) mean += value / double(y.size());
    for (size_t i = 0; i < x.size(); ++i) left += std::pow(y[i] - law(x[i]), 2), all += std::pow(y[i] - mean, 2);
    return 1 - left / all;
}

std::vector<double> logarithms(std::span<const double> values) {
    std::vector<double> out;
    for (const double value : values) out.push_back(std::log(value));
    return out;
}

} // namespace

Fit lineFit(std::span<const double> x, std::span<const double> y) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    if (x.size() < 3 || x.size() != y.size()) return {kNone, kNone, kNone};
    double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
    for (size_t i = 0; i < x.size(); ++i) mean_x += x[i] / double(x.size()), mean_y += y[i] / double(x.size());
    for (size_t i = 0; i < x.size(); ++i)
        xx += (x[i] - mean_x) * (x[i] - mean_x), xy += (x[i] - mean_x) * (y[i] - mean_y);
    Fit fit{mean_y - xy / xx * mean_x, xy / xx, 0};
    fit.r2 = explained(x, y, [&](double at) { return fit.at + fit.slope * at; });
    return fit;
}

Laws lawsOf(std::span<const double> x, std::span<const double> y) {
    const std::vector<double> log_x = logarithms(x), log_y = logarithms(y);
    Laws laws{lineFit(x, y), lineFit(log_x, log_y), lineFit(x, log_y)};
    const Fit &power = laws.power, &exponential = laws.exponential;
    laws.power.r2 = explained(x, y, [&](double at) { return std::exp(power.at + power.slope * std::log(at)); });
    laws.exponential.r2 = explained(x, y, [&](double at) { return std::exp(exponential.at + exponential.slope * at); });
    return laws;
}

std::string describe(const Laws& laws) {
    return fmt::format("affine {:.3g} + {:.3g} x (R² {:.3f}), power x^{:.2f} (R² {:.3f}), exponential e^({:.3g} x) "
                       "(R² {:.3f})",
                       laws.affine.at, laws.affine.slope, laws.affine.r2, laws.power.slope, laws.power.r2,
                       laws.exponential.slope, laws.exponential.r2);
}

} // namespace brume::bench
