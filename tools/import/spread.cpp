#include "tools/import/spread.h"

#include <algorithm>
#include <cmath>

namespace brume::volumes {

namespace {

constexpr int kSweeps = 12;      // four or five are enough
constexpr double kSmall = 1e-14; // of the trace: what is left beside the diagonal

} // namespace

PrincipalAxes principalAxes(const glm::dmat3& covariance) {
    glm::dmat3 m = covariance, unit(1);
    const double trace = m[0][0] + m[1][1] + m[2][2];
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        if (std::abs(m[0][1]) + std::abs(m[0][2]) + std::abs(m[1][2]) <= kSmall * trace) break;
        for (int n = 0; n < 3; ++n) {
            const int p = n, q = (n + 1) % 3;
            if (m[p][q] == 0) continue;
            // The rotation that makes the element (p, q) 0: Golub and Van Loan, Matrix Computations, section 8.5.
            const double tau = (m[q][q] - m[p][p]) / (2 * m[p][q]);
            const double t = (tau >= 0 ? 1 : -1) / (std::abs(tau) + std::sqrt(1 + tau * tau));
            const double c = 1 / std::sqrt(1 + t * t), s = t * c;
            glm::dmat3 turn(1);
            turn[p][p] = c, turn[q][q] = c, turn[q][p] = s, turn[p][q] = -s;
            m = glm::transpose(turn) * m * turn;
            unit = unit * turn;
        }
    }
    PrincipalAxes out;
    out.unit = unit;
    for (int axis = 0; axis < 3; ++axis) out.deviation[axis] = std::sqrt(std::max(m[axis][axis], 0.0));
    return out;
}

glm::dmat3 clampedSpread(const glm::dmat3& covariance, double least, double most) {
    const PrincipalAxes axes = principalAxes(covariance);
    const glm::dvec3 deviation = glm::clamp(axes.deviation, least, most);
    glm::dmat3 scaled = axes.unit;
    for (int axis = 0; axis < 3; ++axis) scaled[axis] *= deviation[axis] * deviation[axis];
    return scaled * glm::transpose(axes.unit);
}

} // namespace brume::volumes
