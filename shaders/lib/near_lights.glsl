// The part of a light that nodes keep at a distance from it; the rest is added exactly (shared/lit_grid.h).
float keptPart(float distance, float spacing) { return smoothstep(kNearNodes, 2 * kNearNodes, distance / spacing); }
