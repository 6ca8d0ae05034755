// The face of a view depth, and the part of a slab, on a pixel's own ray. Include after lib/fog.glsl and
// lib/slab_field.glsl.

// Clamped to the faces that there are. In slabs of fog alone the part is that of the opacity, with which light grows.
float faceOnRay(float depth, vec3 dir) {
    const float at = clamp(faceAt(depth), 0, float(lastFace()));
    const float face = min(floor(at), float(lastFace() - 1));
    if (!isFogAlone(uint(face))) return at;
    const float near = faceDepth(uint(face)), far = faceDepth(uint(face) + 1), metres = length(dir);
    const float whole = opacity(fogBetween(eye.position, dir, metres, near, far));
    const float part = opacity(fogBetween(eye.position, dir, metres, near, clamp(depth, near, far)));
    return face + min(part / max(whole, 1e-30), 1);
}
