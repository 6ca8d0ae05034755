// What the passes of methods `slabs` and `grid` hand to each other, and the order of planes in the field of rays: one
// text, compiled as C++ and as GLSL.
#ifndef BRUME_SHARED_FIELD_H
#define BRUME_SHARED_FIELD_H

#ifdef __cplusplus
#include <compare>
#include <cstdint>
namespace brume::gpu {
using uint = uint32_t;
#define BRUME_INLINE constexpr
#else
#define BRUME_INLINE
#endif

// Quantities of the medium at a slab of a ray or a node of the grid, 1/m.
const uint kExtinction = 0u;
const uint kScattering = 1u; // in red, green and blue; absent if all particles have the same albedo

BRUME_INLINE uint mediumQuantities(bool one_albedo) { return one_albedo ? kScattering : kScattering + 3u; }

// Colours of the light in a field. If all particles have the same albedo, light is without albedo and thus colour.
struct FieldColours {
    uint sun;        // 1 if all particles have the same albedo; otherwise 3: red, green and blue
    uint ambient;    // 3 if there is ambient light, and albedos differ or there is fog; otherwise 0
    uint fog;        // 3 if there is fog; otherwise 0
    uint glow;       // 3 if fog emits light, or particles do and albedos differ or there is fog; otherwise 0
    uint scattering; // 3 if there are local lights, and albedos differ; otherwise 0
    uint lamps;      // 3 if rays hold light of points and spots (lib/lamps_on_rays.glsl); otherwise 0
    uint multiple;   // 0 with single scattering, or if `sun` holds it; 1 if it is without albedo and colour; else 3
    uint model;      // of scattering: kScatteringSingle and so on (multiple.h)
#ifdef __cplusplus
    auto operator<=>(const FieldColours&) const = default; // NOLINT(modernize-use-nullptr): clang-tidy 14: a 0
#endif
};

// Quantities of the field, numbered. A light's colours follow each other.
const uint kFieldDepth = 0u; // optical depth of the particles
const uint kFieldSun = 1u;   // scattered light of the sun, for p E = 1
BRUME_INLINE uint fieldAmbient(FieldColours colours) { return kFieldSun + colours.sun; } // scattered ambient light
// Scattered light of the sun by fogs, for E = 1: with their albedo, and with their phase functions where those differ.
BRUME_INLINE uint fieldFog(FieldColours colours) { return fieldAmbient(colours) + colours.ambient; }
BRUME_INLINE uint fieldGlow(FieldColours colours) { return fieldFog(colours) + colours.fog; } // emitted radiance
// Albedo times optical depth of the particles.
BRUME_INLINE uint fieldScattering(FieldColours colours) { return fieldGlow(colours) + colours.glow; }
// Radiance of the light of points and spots that particles scatter.
BRUME_INLINE uint fieldLamps(FieldColours colours) { return fieldScattering(colours) + colours.scattering; }
// Light of the sun that has scattered more than once, for E = 1: without albedo if it has one colour. Without shadows
// of objects, which dim it otherwise than sunlight, kFieldSun holds it, divided by the ray's phase function.
BRUME_INLINE uint fieldMultiple(FieldColours colours) { return fieldLamps(colours) + colours.lamps; }
BRUME_INLINE uint fieldQuantities(FieldColours colours) { return fieldMultiple(colours) + colours.multiple; }
const uint kMostFieldQuantities = 19u;

// The planes of a field. A plane has a float for each ray.
//
//   quantity 0    quantity 1    ...   with faces         as coefficients of B-splines
//   |             |                   |                  |
//   +-------------+-------------+-----+------------------+------------+-----+--------------------+---------------+
//   | faces + 1   | faces + 1   | ... | the face where   | quantity 0 | ... | with faces: the    | with faces:   |
//   | planes      | planes      |     | a whole ray ends | of whole   |     | face where a whole | 1 where the   |
//   |             |             |     |                  | rays       |     | ray ends           | ends are steep|
//   +-------------+-------------+-----+------------------+------------+-----+--------------------+---------------+
//
//   a quantity:  | up to face 0 (near) | up to face 1 | ... | up to face `slabs` (far) | whole ray |
//
// With fog, `slabs` counts those before and behind the particles, too (lib/slab_depth.glsl).
// A whole ray ends at the surface that it hits. Its light is stored divided by its opacity: both are then smooth where
// the medium is band-limited, however dense it is. In scenes with fog it is divided by what the light would be without
// shadows (lib/field_scale.glsl), which is exact at every pixel and has the sharp edges of fogs; where that is 0, -1 is
// stored. The ends are steep where those of rays around differ by more than a
// slab in the medium, such as on a ground that is seen along it. Whole rays are not smooth there; the planes of faces
// are.
//
// Of a tile of rays only the faces are written that pixels read: those around their surfaces, and all before them where
// an object throws a shadow. Behind the planes are numbers of each tile: the first and the last face written, or 0 as
// last where all surfaces are before the particles; 1 where rays have particles before surfaces, else 0; then
// SlabGrid::caster_words whole numbers, whose bits are the objects that may throw a shadow on the tile's medium.
const uint kFieldKept = 3u;
const uint kWordCasters = 24u; // bits of a number: a float holds whole numbers of so many bits
struct FieldPlanes {
    uint quantities;
    uint faces; // all slabs + 1 in scenes with opaque objects; otherwise 0: there are only whole rays
};

BRUME_INLINE uint facePlane(FieldPlanes field, uint quantity, uint face) {
    return quantity * (field.faces + 1u) + face;
}
BRUME_INLINE uint wholePlane(FieldPlanes field, uint quantity) { return facePlane(field, quantity, field.faces); }
// Planes of the faces at which whole rays end.
BRUME_INLINE uint endPlanes(FieldPlanes field) { return field.faces > 0u ? 1u : 0u; }
BRUME_INLINE uint endPlane(FieldPlanes field) { return facePlane(field, field.quantities, 0u); }
BRUME_INLINE uint splinePlane(FieldPlanes field, uint quantity) {
    return endPlane(field) + endPlanes(field) + quantity;
}
BRUME_INLINE uint endSplinePlane(FieldPlanes field) { return splinePlane(field, field.quantities); }
BRUME_INLINE uint steepPlane(FieldPlanes field) { return endSplinePlane(field) + endPlanes(field); }
BRUME_INLINE uint planesOf(FieldPlanes field) { return steepPlane(field) + endPlanes(field); }

#ifdef __cplusplus
static_assert(fieldQuantities({.sun = 3, .ambient = 3, .fog = 3, .glow = 3, .scattering = 3, .multiple = 3}) ==
              kMostFieldQuantities);
} // namespace brume::gpu
#endif
#undef BRUME_INLINE
#endif
