// PhaseLobes: the numbers of a phase function, in double precision.
#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>

#include "common/scene.h"

namespace brume {

// Values of PhaseSettings::phase.
inline constexpr std::string_view kMixturePhase = "mixture", kDoublePhase = "double", kRayleighPhase = "rayleigh",
                                  kDropletPhase = "droplets";

// p = (1 - part) HG(second) + part D(asymmetry, draine): phaseOfLobes() in shaders/shared/phase.h.
struct PhaseLobes {
    double part = 0, asymmetry = 0;
    double draine = 0; // alpha of Draine's function, >= 0
    double second = 0;
    bool operator==(const PhaseLobes&) const = default;

    // Mean of the cosine of the angle between the directions.
    double meanCosine() const {
        const double g = asymmetry, squares = (1 + 2 * g * g) / 3;
        return part * (g + draine * g * (3 + 2 * g * g) / 5) / (1 + draine * squares) + (1 - part) * second;
    }
    // Mean of the second Legendre polynomial of that cosine: g^2 of Henyey-Greenstein.
    double secondMoment() const {
        const double g2 = asymmetry * asymmetry, squares = (1 + 2 * g2) / 3, fourths = (8 * g2 * g2 + 20 * g2 + 7) / 35;
        const double square = (squares + draine * fourths) / (1 + draine * squares);
        return part * (1.5 * square - 0.5) + (1 - part) * second * second;
    }

    // Least width of what the function has, rad; about 1 where it is smooth.
    double width() const { return 1 - std::max(std::abs(asymmetry), std::abs(second)); }
};

// Water droplets of a diameter from 5 to 50 micrometres: the fit to Mie theory of Jendersie, d'Eon, An Approximate Mie
// Scattering Function for Fog and Cloud Rendering (2023), its part for large droplets.
inline PhaseLobes dropletLobes(double diameter) {
    const double d = diameter;
    return {.part = std::exp(-0.599085 / (d - 0.641583) - 0.665888),
            .asymmetry = std::exp(-2.20679 / (d + 3.91029) - 0.428934),
            .draine = std::exp(3.62489 - 8.29288 / (d + 5.52825)),
            .second = std::exp(-0.0990567 / (d - 1.67154))};
}

inline PhaseLobes lobesOf(const PhaseSettings& medium) {
    const double a = double(medium.anisotropy), g = double(medium.asymmetry);
    if (medium.phase == kDoublePhase) return {a, g, 0, double(medium.second_asymmetry)};
    if (medium.phase == kRayleighPhase) return {1, 0, 1, 0};
    if (medium.phase == kDropletPhase) return dropletLobes(double(medium.droplet));
    return {a, g, 0, 0};
}

// False: light is scattered alike in all directions, whatever the asymmetry.
inline bool hasLobe(const PhaseSettings& medium) { return medium.phase != kMixturePhase || medium.anisotropy > 0; }

} // namespace brume
