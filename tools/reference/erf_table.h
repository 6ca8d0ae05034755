// erf(q) and exp(-q^2) at once: Taylor series of the Gaussian, and its integral, about the nearest multiple of 1/32.
// Absolute error below 1e-13, tested against libm.
#pragma once

#include <array>
#include <cmath>

namespace brume::reference {

class ErfTable {
public:
    struct Pair {
        double erf, gauss;
    };

    static const ErfTable& shared() {
        static const ErfTable table;
        return table;
    }

    ErfTable() {
        for (int i = 0; i < kCount; ++i) {
            const double x = i / kPerUnit;
            Entry& e = entries_[i];
            e.erf = std::erf(x);
            e.taylor[0] = std::exp(-x * x);
            e.taylor[1] = -2 * x * e.taylor[0];
            // g' = -2 x g
            for (int n = 1; n < 6; ++n) e.taylor[n + 1] = -2 * (x * e.taylor[n] + e.taylor[n - 1]) / (n + 1);
        }
    }

    Pair at(double q) const {
        const double size = std::abs(q);
        if (!(size < kEnd)) return {std::copysign(1.0, q), 0};
        const int i = static_cast<int>(size * kPerUnit + 0.5);
        const double d = size - i / kPerUnit;
        const auto& a = entries_[i].taylor;
        const double gauss = a[0] + d * (a[1] + d * (a[2] + d * (a[3] + d * (a[4] + d * (a[5] + d * a[6])))));
        return {std::copysign(entries_[i].erf + integral(a, d), q), gauss};
    }
    double erf(double q) const {
        const double size = std::abs(q);
        if (!(size < kEnd)) return std::copysign(1.0, q);
        const int i = static_cast<int>(size * kPerUnit + 0.5);
        return std::copysign(entries_[i].erf + integral(entries_[i].taylor, size - i / kPerUnit), q);
    }

private:
    static constexpr double kPerUnit = 32, kEnd = 6;
    static constexpr int kCount = 193;
    struct alignas(64) Entry {
        double erf;
        std::array<double, 7> taylor;
    };

    // 2/sqrt(pi) times the integral of the Gaussian from the entry to d beyond it.
    static double integral(const std::array<double, 7>& a, double d) {
        return 1.12837916709551257390 * d *
               (a[0] + d * (a[1] * (1.0 / 2) +
                            d * (a[2] * (1.0 / 3) +
                                 d * (a[3] * (1.0 / 4) +
                                      d * (a[4] * (1.0 / 5) + d * (a[5] * (1.0 / 6) + d * a[6] * (1.0 / 7)))))));
    }

    std::array<Entry, kCount> entries_;
};

} // namespace brume::reference
