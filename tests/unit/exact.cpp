#include "tests/unit/exact.h"

#include <boost/math/special_functions/erf.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>

namespace brume::exact {

using Exact = boost::multiprecision::cpp_bin_float_50;

double erf(double x) { return static_cast<double>(boost::math::erf(Exact(x))); }

double erfc(double x) { return static_cast<double>(boost::math::erfc(Exact(x))); }

double erfcx(double x) {
    const Exact y = x;
    if (x < 1000) return static_cast<double>(exp(y * y) * boost::math::erfc(y));
    return static_cast<double>((1 - 1 / (2 * y * y)) /
                               (y * sqrt(boost::math::constants::pi<Exact>()))); // next term 1e-12
}

double erfDifference(double a, double h) {
    // On the side where both tails are small; 50 digits stand the difference.
    const Exact lo = a, hi = lo + h;
    return static_cast<double>(lo + hi > 0 ? boost::math::erfc(lo) - boost::math::erfc(hi)
                                           : boost::math::erfc(-hi) - boost::math::erfc(-lo));
}

double phi(double x) { return x == 0 ? 1 : static_cast<double>(-boost::multiprecision::expm1(-Exact(x)) / Exact(x)); }

double opacity(double x) { return static_cast<double>(-boost::multiprecision::expm1(-Exact(x))); }

double depthOfOpacity(double y) { return static_cast<double>(-boost::multiprecision::log1p(-Exact(y))); }

double henyeyGreenstein(double cosine, double g) {
    const Exact d = 1 + Exact(g) * g - 2 * Exact(g) * cosine;
    return static_cast<double>((1 - Exact(g) * g) / (4 * boost::math::constants::pi<Exact>() * d * sqrt(d)));
}

} // namespace brume::exact
