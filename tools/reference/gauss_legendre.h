// Gauss-Legendre quadrature with n nodes on (-1, 1), and the Legendre coefficients of a function known at the nodes.
#pragma once

#include <array>
#include <cmath>

namespace brume::reference {

class GaussLegendre {
public:
    static constexpr int kMost = 16;
    template <typename T>
    using Values = std::array<T, kMost>; // the first size() count

    // n in 2 ... kMost.
    explicit GaussLegendre(int n) : size_(n) {
        constexpr double pi = 3.14159265358979323846;
        for (int i = 0; i < n; ++i) {
            double x = -std::cos(pi * (i + 0.75) / (n + 0.5)), slope = 1;
            for (int step = 0; step < 20; ++step) { // Newton on P_n
                const auto p = polynomials(x);
                slope = n * (x * p[n] - p[n - 1]) / (x * x - 1);
                x -= p[n] / slope;
            }
            nodes_[i] = x;
            weights_[i] = 2 / ((1 - x * x) * slope * slope);
            const auto p = polynomials(x);
            for (int m = 0; m < n; ++m) to_coefficient_[m][i] = (2 * m + 1) * 0.5 * weights_[i] * p[m];
        }
    }

    int size() const { return size_; }
    double node(int i) const { return nodes_[i]; }
    double weight(int i) const { return weights_[i]; }

    template <typename T>
    T coefficient(int m, const Values<T>& f) const {
        T sum(0);
        for (int i = 0; i < size_; ++i) sum += to_coefficient_[m][i] * f[i];
        return sum;
    }

private:
    static std::array<double, kMost + 1> polynomials(double x) {
        std::array<double, kMost + 1> p{1, x};
        for (int m = 1; m < kMost; ++m) p[m + 1] = ((2 * m + 1) * x * p[m] - m * p[m - 1]) / (m + 1);
        return p;
    }

    int size_;
    std::array<double, kMost> nodes_{}, weights_{};
    std::array<std::array<double, kMost>, kMost> to_coefficient_{};
};

} // namespace brume::reference
