// Laws through measured points: how a time grows.
#pragma once

#include <span>
#include <string>

namespace brume::bench {

struct Fit {
    double at = 0, slope = 0; // y = at + slope x
    double r2 = 0;            // of y; 1: all points are on the line
};
// Least squares. NaN below three points.
Fit lineFit(std::span<const double> x, std::span<const double> y);

struct Laws {
    Fit affine;      // y = at + slope x
    Fit power;       // y = e^at x^slope
    Fit exponential; // y = e^at e^(slope x)
};
// R^2 is of y itself for all three, so that they compare. x and y are positive.
Laws lawsOf(std::span<const double> x, std::span<const double> y);
// "affine 0.2 + 0.01 x (R² 0.99), power x^0.5 (R² 0.9), exponential e^(0.02 x) (R² 0.8)".
std::string describe(const Laws& laws);

} // namespace brume::bench
