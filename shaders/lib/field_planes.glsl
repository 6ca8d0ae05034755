// Addresses in `field`, the buffer of planes that shared/field.h describes. Include after lib/view.glsl, kHasOpaque,
// kSunColours, kAmbientColours and kMultipleColours are declared.
#include "shaders/shared/field.h"
#include "shaders/shared/scatter.h"
#include "shaders/lib/has_emission.glsl"
#include "shaders/lib/has_fog.glsl"
#include "shaders/lib/has_local_lights.glsl"

const bool kLampsOnRays = kHasLocalLights && !kHasFog; // True: rays hold light of points and spots

// True: rays hold light that media emit. Without fog, and of one albedo, it follows from the opacity.
bool holdsGlow() { return kHasGlow || (kHasEmission && (kHasFog || kSunColours == 3)); }

FieldColours fieldColours() {
    return FieldColours(kSunColours, kAmbientColours, kHasFog ? 3 : 0, holdsGlow() ? 3 : 0,
                        kHasLocalLights && kSunColours == 3 ? 3 : 0, kLampsOnRays ? 3 : 0, kMultipleColours, 0);
}
uint fieldAmbient() { return fieldAmbient(fieldColours()); }
uint fieldFog() { return fieldFog(fieldColours()); }
uint fieldGlow() { return fieldGlow(fieldColours()); }
uint fieldScattering() { return fieldScattering(fieldColours()); }
uint fieldLamps() { return fieldLamps(fieldColours()); }
uint fieldMultiple() { return fieldMultiple(fieldColours()); }
uint fieldQuantities() { return fieldQuantities(fieldColours()); }
// True if rays hold some lamp's light in this view. If not, its quantities are neither written nor read.
bool areLampsHeld() { return kLampsOnRays && grid.lamp_spacing > 0; }
bool isHeld(uint quantity) {
    return !kLampsOnRays || quantity - fieldLamps() >= 3 || areLampsHeld(); // the difference of a smaller one wraps
}

uint fieldNodes() { return grid.nodes.x * grid.nodes.y; }
FieldPlanes fieldPlanes() { return FieldPlanes(fieldQuantities(), kHasOpaque ? lastFace() + 1 : 0); }
// Index of a plane's first node.
uint planeAt(uint plane) { return field_at + plane * fieldNodes(); }
uint fieldFace(uint quantity, uint face) { return planeAt(facePlane(fieldPlanes(), quantity, face)); }
uint fieldWhole(uint quantity) { return planeAt(wholePlane(fieldPlanes(), quantity)); }
uint fieldEnd() { return planeAt(endPlane(fieldPlanes())); }
uint fieldSpline(uint quantity) { return planeAt(splinePlane(fieldPlanes(), quantity)); }
uint fieldEndSpline() { return planeAt(endSplinePlane(fieldPlanes())); }
uint fieldSteep() { return planeAt(steepPlane(fieldPlanes())); }
// Index of what tells of a tile's rays which faces are written and whether there is medium (shared/field.h).
uint fieldKept(uvec2 tile) {
    return planeAt(planesOf(fieldPlanes())) + (kFieldKept + grid.caster_words) * (tile.y * grid.lines.x + tile.x);
}

// The four faces whose values betweenFaces() takes, around the one of index `near` and the next. At the ends of a ray
// the outermost is missing, and its neighbour takes its place.
uvec4 facesAround(uint near) { return uvec4(max(near, 1) - 1, near, near + 1, min(near + 2, lastFace())); }

// A quantity at the part `at` of the way from the second face, of index `face`, to the third.
float betweenFaces(vec4 values, float at, uint face) {
    const vec3 added = values.yzw - values.xyz;
    return values.y + added.y * (isFogAlone(face) ? at : addedBefore(added.x, added.y, added.z, at));
}

// True if no ray of the nodes `lo` ... `hi` has medium. At most 9 nodes each way; hi may lie beyond the last.
bool isClear(uvec2 lo, uvec2 hi) {
    const uvec2 a = lo / kSlabTile, b = min(hi / kSlabTile, grid.lines.xy - 1);
    return field[fieldKept(a) + 2] + field[fieldKept(uvec2(b.x, a.y)) + 2] + field[fieldKept(uvec2(a.x, b.y)) + 2] +
               field[fieldKept(b) + 2] == 0;
}
