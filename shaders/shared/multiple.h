// Light that scatters more than once. Two models: octaves, and six fluxes through cells.
//
// Octaves (Wrenninge, Kulla, Lundqvist, Oz: The Great and Volumetric, 2013): single scattering in ever thinner media.
// Octave n scatters a^n, its light passes b^n of the optical depth, and its asymmetry is c^n of the medium's. With
// a <= b no place scatters more light than it gets: what octave n takes out of a beam is a^n / b^n of it, at most.
//
// Six fluxes: discrete ordinates along the axes (as Siddall and Selcuk 1979), of which each stands for 4 pi / 6 sr. The
// sun's beam is scaled (delta-Eddington; Joseph, Wiscombe, Weinman 1976): the part f of scattered light goes straight
// on and counts as not scattered. What is scattered out of the scaled beam is the fluxes' source. In a thick medium
// they follow the diffusion equation; in empty space they go straight on and leave.
#ifndef BRUME_SHARED_MULTIPLE_H
#define BRUME_SHARED_MULTIPLE_H

#include "transmittance.h"

#ifdef __cplusplus
#include <cstdint>
namespace brume::gpu {
using uint = uint32_t;
#endif
const uint kScatteringSingle = 0u, kScatteringOctaves = 1u, kScatteringPropagation = 2u;
// Numbers of octaves: the eighth adds 1/128 of the first one's light; a = b is the most light that is physical.
const uint kOctaves = 8u;
const float kOctaveScattering = 0.5f, kOctaveExtinction = 0.5f, kOctavePhase = 0.5f; // a, b, c
const uint kFluxLevels = 3u; // grids of cells: each has half as many along a side as the one before
#ifdef __cplusplus
} // namespace brume::gpu
#endif

BRUME_PHYSICS_BEGIN

// The part f of scattered light that goes straight on, from the mean cosine g and the mean m2 of the second Legendre
// polynomial, which is g^2 for Henyey-Greenstein. At least m2 where it is positive, and so much that beamAsymmetry() is
// at most 1/3: then no flux is negative. In [0, 1).
BRUME_FN real straightPart(real g, real m2) {
    return clamp(max(m2, (real(3) * g - real(1)) * real(0.5)), real(0), real(0.999999));
}
// Mean cosine of what is left; in [-1/3, 1/3].
BRUME_FN real beamAsymmetry(real g, real straight) {
    return clamp((g - straight) / (real(1) - straight), real(-1.0 / 3.0), real(1.0 / 3.0));
}
// Extinction of the scaled beam, in parts of the extinction; in [1 - albedo, 1].
BRUME_FN real passedPart(real albedo, real straight) { return real(1) - albedo * straight; }
// Albedo of the scaled medium.
BRUME_FN real scaledAlbedo(real albedo, real straight) {
    return albedo * (real(1) - straight) / max(passedPart(albedo, straight), real(1e-6));
}

// The straight part of a medium whose albedo it is, from its passedPart() and its scaledAlbedo(). In [0, 1].
BRUME_FN real straightOf(real passed, real scaled) {
    const real albedo = scaled * passed + real(1) - passed;
    return albedo > real(0) ? min((real(1) - passed) / albedo, real(1)) : real(0);
}

// Power that the scaled beam of irradiance 1 loses by scattering in a cell, over the power that the cell's extinction
// would take from an irradiance of 1. before: optical depth of the scaled medium between the light and the cell; own:
// through the cell.
BRUME_FN real firstScattered(real albedo, real before, real own) { return albedo * exp(-before) * phi(own); }

// Along each axis the power per area, W/m^2, that goes up and down it.
BRUME_STRUCT Fluxes {
    BRUME_VEC3 up;
    BRUME_VEC3 down;
};
BRUME_STRUCT FluxCell {
    BRUME_OF(Fluxes) leaving; // what leaves the cell
    real fluence;             // mean in the cell, W/m^2
    BRUME_VEC3 flux;          // mean net flux, W/m^2
};

// One cell. entering: what enters it; depth: its optical thickness along each axis; albedo, asymmetry: of the scaled
// medium; source: firstScattered(); beam: mean way of the light that is scattered first, at most 1 long. The cell's own
// scattering is solved for exactly, for even sources in it. All is >= 0 if `entering` and `source` are, and
// |asymmetry| <= 1/3. With albedo 1 and equal fluxes around it a cell changes none.
BRUME_FN BRUME_OF(FluxCell)
    passCell(BRUME_OF(Fluxes) entering, BRUME_VEC3 depth, real albedo, real asymmetry, real source, BRUME_VEC3 beam) {
    const BRUME_VEC3 mean_part = BRUME_VEC3(phi(depth.x), phi(depth.y), phi(depth.z)); // of what enters, on average
    const BRUME_VEC3 made_part = BRUME_VEC3(1) - mean_part;
    const BRUME_VEC3 sum = mean_part * (entering.up + entering.down),
                     difference = mean_part * (entering.up - entering.down);
    const real own = (made_part.x + made_part.y + made_part.z) / real(3);
    const real kept = (mean_part.x + mean_part.y + mean_part.z) / real(3); // 1 - own, without cancellation
    BRUME_OF(FluxCell) cell;
    cell.fluence = (sum.x + sum.y + sum.z + source * own) / max((real(1) - albedo) + albedo * kept, real(1e-30));
    cell.flux = (difference + asymmetry * source * made_part * beam) / (BRUME_VEC3(1) - albedo * asymmetry * made_part);
    const real even = (albedo * cell.fluence + source) / real(6);
    const BRUME_VEC3 tilt = real(0.5) * asymmetry * (albedo * cell.flux + source * beam);
    const BRUME_VEC3 made = min(depth * mean_part, BRUME_VEC3(1)); // 1 - e^(-depth)
    const BRUME_VEC3 passed = BRUME_VEC3(1) - made;
    cell.leaving.up = passed * entering.up + made * (BRUME_VEC3(even) + tilt);
    cell.leaving.down = passed * entering.down + made * (BRUME_VEC3(even) - tilt);
    return cell;
}

// Radiance per unit of scattering that light of this fluence and net flux has when it is scattered toward the unit
// direction `toward`, to first order in the mean cosine.
BRUME_FN real scatteredFluence(real fluence, BRUME_VEC3 flux, real mean_cosine, BRUME_VEC3 toward) {
    return max(fluence + real(3) * mean_cosine * dot(flux, toward), real(0)) * real(0.07957747154594767);
}

BRUME_PHYSICS_END

#endif
