// Gauss-Legendre quadrature with N nodes on (-1, 1), with what a panel of a ray needs besides: the integral up to each node, and
// the Legendre coefficients of a function known at the nodes.
#pragma once

#include <array>
#include <cmath>

namespace brume::reference {

template <int N>
class GaussLegendre {
public:
    using Values = std::array<double, N>;

    GaussLegendre() {
        constexpr double pi = 3.14159265358979323846;
        for (int i = 0; i < N; ++i) {
            double x = -std::cos(pi * (i + 0.75) / (N + 0.5)), slope = 1;
            for (int step = 0; step < 20; ++step) { // Newton on P_N
                const auto p = polynomials(x);
                slope = N * (x * p[N] - p[N - 1]) / (x * x - 1);
                x -= p[N] / slope;
            }
            nodes_[i] = x;
            weights_[i] = 2 / ((1 - x * x) * slope * slope);
        }
        for (int k = 0; k < N; ++k) {
            const auto at_k = polynomials(nodes_[k]);
            for (int n = 0; n < N; ++n) to_coefficient_[n][k] = (2 * n + 1) * 0.5 * weights_[k] * at_k[n];
            for (int j = 0; j < N; ++j) {
                const auto at_j = polynomials(nodes_[j]);
                double integral = nodes_[j] + 1;
                for (int n = 1; n < N; ++n) integral += at_k[n] * (at_j[n + 1] - at_j[n - 1]);
                up_to_[j][k] = 0.5 * weights_[k] * integral;
            }
        }
    }

    const Values& nodes() const { return nodes_; }
    const Values& weights() const { return weights_; }

    // Integral of the interpolant from -1 to node j.
    double upTo(int j, const Values& f) const { return dot(up_to_[j], f); }

    Values coefficients(const Values& f) const {
        Values c;
        for (int n = 0; n < N; ++n) c[n] = dot(to_coefficient_[n], f);
        return c;
    }

    // The interpolant with these coefficients at x in [-1, 1].
    static double evaluate(const Values& c, double x) {
        const auto p = polynomials(x);
        double sum = 0;
        for (int n = 0; n < N; ++n) sum += c[n] * p[n];
        return sum;
    }

private:
    static std::array<double, N + 1> polynomials(double x) {
        std::array<double, N + 1> p{1, x};
        for (int n = 1; n < N; ++n) p[n + 1] = ((2 * n + 1) * x * p[n] - n * p[n - 1]) / (n + 1);
        return p;
    }
    static double dot(const Values& a, const Values& b) {
        double sum = 0;
        for (int n = 0; n < N; ++n) sum += a[n] * b[n];
        return sum;
    }

    Values nodes_{}, weights_{};
    std::array<Values, N> up_to_{}, to_coefficient_{};
};

} // namespace brume::reference
