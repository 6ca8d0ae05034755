// The range of every number in a scene, ends included. One list: the loader refuses what is outside, commands are
// clamped to it.
#pragma once

#include <algorithm>

namespace brume {

struct Limits {
    double lo, hi;
    constexpr bool holds(double value) const { return value >= lo && value <= hi; } // false for NaN
    float clamp(float value) const { return static_cast<float>(std::clamp(static_cast<double>(value), lo, hi)); }
};

namespace limits {

// Any length, and any place relative to the scene's origin: float32 still resolves 4 mm at 50 km, far below the
// smallest useful particle there.
inline constexpr Limits kPlace{-5e4, 5e4}, kLength{1e-3, 1e4};
inline constexpr Limits kOrigin{-1e7, 1e7}; // of a scene, in doubles: beyond the Earth's radius
inline constexpr Limits kColour{0, 1}, kRadiance{0, 1e4}, kSpeed{-100, 100};

inline constexpr Limits kCount{1, 1'000'000};
inline constexpr Limits kScale{1e-3, 1e5};   // m, of particles
inline constexpr Limits kFalloff{0.1, 10};   // 000's slider ends at 10; at 0 a particle has no extent
inline constexpr Limits kHaze{0, 1e3};       // 1/m
inline constexpr Limits kExtinction{0, 1e5}; // 000's slider ends at 100, which is thin for particles of centimetres
inline constexpr Limits kMultiplier{0, 1e3};
inline constexpr Limits kSigmaT{0, 1e4};           // 1/m, a point's own
inline constexpr Limits kVolumeNodes{1, 25165824}; // of a volume: they fill gpu::kLargestBinding
inline constexpr Limits kAnisotropy{0, 1};
inline constexpr Limits kAsymmetry{-0.99, 0.99};
inline constexpr Limits kDroplet{5, 50};                                             // micrometres; the fit's range
inline constexpr Limits kStructure{0, 1};                                            // of an albedo, as a part of it
inline constexpr Limits kPlanes{0, 64}, kObjects{0, 4096};                           // how many; boxes and spheres
inline constexpr Limits kMeshes{0, 64}, kTriangles{1, 500'000};                      // how many; of all meshes
inline constexpr Limits kMeshScale{1e-6, 1e6}, kUnit{1e-9, 1e9};                     // m per unit of a file
inline constexpr Limits kFogs{0, 4};                                                 // how many
inline constexpr Limits kFogFalloff{0, 100}, kFogRadius{0, 1e4};                     // 1/m; m
inline constexpr Limits kLocalLights{0, 1024};                                       // how many
inline constexpr Limits kShadowedLights{0, 64};                                      // how many may shadow particles
inline constexpr Limits kIntensity{0, 1e8};                                          // W/sr
inline constexpr Limits kLightRange{0, 1e5}, kLightRadius{0, 100}, kCone{0.01, 1.5}; // m; m; rad
inline constexpr Limits kSeed{0, 9'007'199'254'740'992.0}; // 2^53: every double between is a whole number

inline constexpr Limits kRate{1e-3, 1e6}, kLife{0.1, 120}, kCooling{0, 120}, kGrowth{0, 100}, kAcceleration{-100, 100},
    kTurbulence{0, 100};

inline constexpr Limits kSpring{0, 1000}; // 1/s^2: far below the 4 / dt^2 = 14400 where the 60 Hz step turns unstable
inline constexpr Limits kViscosity{0, 100};
inline constexpr Limits kImpulseStrength{-100, 100}, kStrength{-10, 10};
inline constexpr Limits kPeriod{0.1, 1e4}, kRotate{-10, 10}, kAngle{-1e3, 1e3};

inline constexpr Limits kFileRate{1e-3, 1e3}; // 1/s, of a sequence
inline constexpr Limits kMoveTime{0, 60};     // s, of particles that are set

inline constexpr Limits kFovY{0.05, 3.0}, kEyeSeparation{0, 10};   // m; people have 0.065, giants and models more
inline constexpr Limits kCameraKeys{0, 64}, kKeySeconds{0.1, 600}; // how many; s
inline constexpr Limits kExposure{1e-4, 1e4}, kSteps{1, 10}, kTransmittanceSteps{1, 3};
inline constexpr Limits kTetrahedra{1, 2e6}, kTetrahedraNodes{1, 3}; // how many; along a ray in each
inline constexpr Limits kRayRate{1, 16}, kSlabs{1, 512}, kShading{1, 8}, kGridSpacing{0.01, 1}, kLampSpacing{1e-3, 10};
inline constexpr Limits kFroxelPixels{1, 32}, kSlices{8, 512}, kHistory{0, 0.98};
inline constexpr Limits kVoxel{0.005, 100}; // m
inline constexpr Limits kLightError{1e-9, 1}, kLightLevels{0, 3}, kLightSamples{1, 16384};
inline constexpr Limits kLightStep{0.05, 16}, kLightNear{0, 16};      // spacings of nodes
inline constexpr Limits kUnionRadius{1e-3, 10}, kUnionCount{1, 8192}; // per scale; particles
inline constexpr Limits kPathGroups{1, 64}, kPathCutoff{0, 256};      // ticks; hits
inline constexpr Limits kSpriteSize{0.1, 4};                          // radii
inline constexpr Limits kMarchSamples{1, 256};
inline constexpr Limits kPart{0, 1}, kPropagationCells{8, 64}, kIterations{1, 256}, kSurfaceParts{0, 16};
inline constexpr Limits kGlasses{0, 16}, kTilt{-1.6, 1.6}; // how many; rad
inline constexpr Limits kMerge{0, 8};                      // pixels: beyond, nothing of a picture is left
inline constexpr Limits kError{1e-5, 1}, kFlip{1e-5, 1};
inline constexpr Limits kShadowError{1e-4, 0.1}, kLightTolerance{0, 1}, kLeastTransmittance{0, 0.1};
inline constexpr Limits kShadowSize{8, 1024}, kOpaqueShadowSize{16, 8192}, kCutoff{0, 0.1};
inline constexpr Limits kShadowSlices{2, 193};   // a tile's list has bits for 32 groups of six
inline constexpr Limits kShadowExtent{0.1, 1e4}; // m
inline constexpr Limits kTaylorStep{1e-4, 10};   // m: the program of seed 000 has 1e-3

} // namespace limits
} // namespace brume
