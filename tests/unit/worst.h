// Worst: keeps the largest deviation over a grid and its position, so that one assertion covers the grid.
#pragma once

#include <cmath>
#include <limits>
#include <ostream>

namespace brume {

class Worst {
public:
    void relative(double value, double exact, double at, double at2 = 0) {
        take(std::abs(value - exact) / std::abs(exact), at, at2);
    }
    void absolute(double value, double exact, double at, double at2 = 0) { take(std::abs(value - exact), at, at2); }
    double deviation() const { return deviation_; }
    friend std::ostream& operator<<(std::ostream& out, const Worst& worst) {
        return out << worst.deviation_ << " at (" << worst.at_ << ", " << worst.at2_ << ")";
    }

private:
    // NaN counts as infinitely wrong.
    void take(double deviation, double at, double at2) {
        if (deviation <= deviation_) return;
        deviation_ = std::isnan(deviation) ? std::numeric_limits<double>::infinity() : deviation;
        at_ = at;
        at2_ = at2;
    }
    double deviation_ = 0, at_ = 0, at2_ = 0;
};

} // namespace brume
